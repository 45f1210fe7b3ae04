// SPDX-License-Identifier: Apache-2.0
#include "feature/rolling_shutter.h"

#include <gtest/gtest.h>

#include "testing/view.h"

namespace rds {
namespace {

// A point at rest as a camera that moves sees it in the row that is exposed at that moment.
Keypoint SeeInItsRow(const PinholeCamera& camera, const Tangent6& velocity, const Eigen::Vector3d& point) {
  double after_s = 0;
  Keypoint keypoint;
  for (int i = 0; i < 20; ++i) {  // the row says the moment, the moment the row
    keypoint = See(Rigid3{ExpSo3(after_s * velocity.tail<3>()), after_s * velocity.head<3>()}, point);
    after_s = (static_cast<double>(keypoint.raw_y) / camera.height - 0.5) * camera.rolling_shutter_s;
  }
  return keypoint;
}

TEST(RollingShutter, PutsKeypointsWhereTheMiddleRowsMomentHasThem) {
  PinholeCamera camera = TestCamera();
  camera.rolling_shutter_s = 0.03;
  Tangent6 velocity;
  velocity << 0.4, -0.3, 0.5, 0.5, -1, 0.7;  // handheld, turning fast
  double most_px = 0;
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0, 0, 2), {0.5, 0.6, 1.5}, {-0.7, -0.5, 1.2}, {1, -0.8, 2.5}}) {
    const Keypoint exact = See({}, point);
    std::vector<Keypoint> keypoints = {SeeInItsRow(camera, velocity, point)};
    const double before_px = (keypoints[0].Pixel() - exact.Pixel()).norm();
    CorrectRollingShutter(camera, velocity, keypoints);
    EXPECT_LT((keypoints[0].Pixel() - exact.Pixel()).norm(), 0.05 * before_px + 0.02);
    most_px = std::max(most_px, before_px);
  }
  EXPECT_GT(most_px, 5);
}

TEST(RollingShutter, WithoutDepthTheTurnIsTakenOut) {
  PinholeCamera camera = TestCamera();
  camera.rolling_shutter_s = 0.03;
  Tangent6 velocity = Tangent6::Zero();
  velocity[4] = 1.5;
  const Eigen::Vector3d point(0.3, 0.6, 1.5);
  std::vector<Keypoint> keypoints = {SeeInItsRow(camera, velocity, point)};
  keypoints[0].depth_m = 0;
  CorrectRollingShutter(camera, velocity, keypoints);
  EXPECT_LT((keypoints[0].Pixel() - See({}, point).Pixel()).norm(), 0.2);
}

TEST(RollingShutter, ChangesNothingWhereAllRowsAreExposedAtOnceOrNothingMoves) {
  PinholeCamera camera = TestCamera();
  const std::vector<Keypoint> before = {See({}, {0.5, 0.6, 1.5})};
  std::vector<Keypoint> keypoints = before;
  CorrectRollingShutter(camera, Tangent6::Constant(1), keypoints);
  EXPECT_EQ(keypoints[0].Pixel(), before[0].Pixel());
  camera.rolling_shutter_s = 0.03;
  CorrectRollingShutter(camera, Tangent6::Zero(), keypoints);
  EXPECT_EQ(keypoints[0].Pixel(), before[0].Pixel());
}

}  // namespace
}  // namespace rds
