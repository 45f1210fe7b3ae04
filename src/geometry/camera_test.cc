// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = 500;
  camera.fy = 510;
  camera.cx = 320;
  camera.cy = 240;
  camera.baseline_m = 0.1;
  return camera;
}

TEST(PinholeCamera, ProjectsKnownPoints) {
  EXPECT_EQ(TestCamera().Project({0, 0, 3}), Eigen::Vector2d(320, 240));
  EXPECT_EQ(TestCamera().Project({1, -1, 2}), Eigen::Vector2d(570, -15));
}

TEST(PinholeCamera, UnprojectUndoesProject) {
  const Eigen::Vector3d point(0.4, -0.3, 1.7);
  EXPECT_TRUE(TestCamera().Unproject(TestCamera().Project(point), 1.7).isApprox(point, 1e-14));
}

TEST(PinholeCamera, KnowsItsDistortionAndBaseline) {
  PinholeCamera camera = TestCamera();
  EXPECT_FALSE(camera.HasDistortion());
  camera.distortion[2] = 1e-4;
  EXPECT_TRUE(camera.HasDistortion());
  EXPECT_DOUBLE_EQ(camera.Bf(), 50);
}

}  // namespace
}  // namespace rds
