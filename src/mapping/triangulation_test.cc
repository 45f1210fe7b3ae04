// SPDX-License-Identifier: Apache-2.0
#include "mapping/triangulation.h"

#include <gtest/gtest.h>

#include "testing/view.h"

namespace rds {
namespace {

const Rigid3 kLeft{};
const Rigid3 kRight{ExpSo3({0, 0.05, 0}), {-0.4, 0.02, 0}};
const Eigen::Vector3d kPoint(0.3, -0.2, 2.5);

TEST(Triangulation, FindsThePointFromTwoRays) {
  const Keypoint a = See(kLeft, kPoint, false);
  const Keypoint b = See(kRight, kPoint, false);
  const auto found = TriangulatePoint(TestCamera(), ScalePyramid(), {&a, kLeft}, {&b, kRight});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - kPoint).norm(), 1e-4);
}

TEST(Triangulation, TakesDepthWhereTheRaysAreNearlyParallel) {
  const Rigid3 near_left{Eigen::Quaterniond::Identity(), {-0.01, 0, 0}};
  const Keypoint a = See(kLeft, kPoint, true);
  const Keypoint b = See(near_left, kPoint, false);
  const auto found = TriangulatePoint(TestCamera(), ScalePyramid(), {&a, kLeft}, {&b, near_left});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - kPoint).norm(), 1e-4);
  const Keypoint blind = See(kLeft, kPoint, false);
  EXPECT_FALSE(TriangulatePoint(TestCamera(), ScalePyramid(), {&blind, kLeft}, {&b, near_left}).has_value());
}

TEST(Triangulation, TakesWhatIsMorePrecise) {
  // 9 degrees between the rays, so a pixel is a centimeter and a half along them: depth of a centimeter wins, depth of
  // a decimeter does not.
  Keypoint a = See(kLeft, kPoint, true);
  const Keypoint b = See(kRight, kPoint, false);
  for (const float sigma_m : {0.01F, 0.1F}) {
    a.depth_m = static_cast<float>(kPoint.z()) + 0.005F;
    a.depth_sigma_m = sigma_m;
    const auto found = TriangulatePoint(TestCamera(), ScalePyramid(), {&a, kLeft}, {&b, kRight});
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->z() - kPoint.z(), sigma_m < 0.05F ? 0.005 : 0, 1e-4);
  }
}

TEST(Triangulation, RefusesWhatDoesNotFit) {
  const Keypoint a = See(kLeft, kPoint, false);
  Keypoint off = See(kRight, kPoint, false);
  off.y += 10;
  EXPECT_FALSE(TriangulatePoint(TestCamera(), ScalePyramid(), {&a, kLeft}, {&off, kRight}).has_value());
  Keypoint behind = See(kRight, kPoint, false);
  behind.x += 200;  // the rays meet behind the cameras
  EXPECT_FALSE(TriangulatePoint(TestCamera(), ScalePyramid(), {&a, kLeft}, {&behind, kRight}).has_value());
  Keypoint coarse = See(kRight, kPoint, false);
  coarse.octave = 7;  // seen far smaller than the distances say
  EXPECT_FALSE(TriangulatePoint(TestCamera(), ScalePyramid(), {&a, kLeft}, {&coarse, kRight}).has_value());
}

}  // namespace
}  // namespace rds
