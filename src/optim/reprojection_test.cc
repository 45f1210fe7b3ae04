// SPDX-License-Identifier: Apache-2.0
#include "optim/reprojection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/numeric_jacobian.h"

namespace rds {
namespace {

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = 520;
  camera.fy = 515;
  camera.cx = 318;
  camera.cy = 243;
  return camera;
}

PixelObservation TestKeypoint(bool has_depth) {
  PixelObservation keypoint;
  keypoint.pixel = {300, 200};
  keypoint.inverse_depth = has_depth ? 0.5 : 0;
  keypoint.depth_px = has_depth ? 120 : 0;
  keypoint.inverse_sigma2 = 0.6;
  keypoint.weight = 0.7;
  return keypoint;
}

const Eigen::Vector3d kPoint(0.3, -0.2, 2.1);

TEST(Reprojection, ErrorIsMeasuredMinusProjected) {
  const PinholeCamera camera = TestCamera();
  const Eigen::Vector2d projected = camera.Project(kPoint);
  const Eigen::Vector3d with = ReprojectionError(camera, TestKeypoint(true), kPoint);
  EXPECT_NEAR(with.x(), 300 - projected.x(), 1e-12);
  EXPECT_NEAR(with.y(), 200 - projected.y(), 1e-12);
  EXPECT_NEAR(with.z(), 120 * (0.5 - 1 / kPoint.z()), 1e-12);
  const Eigen::Vector3d without = ReprojectionError(camera, TestKeypoint(false), kPoint);
  EXPECT_EQ(without.head<2>(), with.head<2>());
  EXPECT_EQ(without.z(), 0);
}

TEST(Reprojection, JacobianMatchesDifferences) {
  for (const bool has_depth : {false, true}) {
    const PixelObservation keypoint = TestKeypoint(has_depth);
    const Eigen::Matrix3d analytic = ReprojectionJacobian(TestCamera(), keypoint, kPoint);
    const Eigen::Matrix3d numeric = NumericJacobian<3, 3>(
        [&](const Eigen::Vector3d& point) { return ReprojectionError(TestCamera(), keypoint, point); }, kPoint);
    EXPECT_LT((analytic - numeric).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(analytic.row(2).isZero(0), !has_depth);
  }
}

TEST(Reprojection, Chi2IsUnweighted) {
  const PixelObservation keypoint = TestKeypoint(true);
  const double squared_px = ReprojectionError(TestCamera(), keypoint, kPoint).squaredNorm();
  EXPECT_NEAR(ReprojectionChi2(TestCamera(), keypoint, kPoint), 0.6 * squared_px, 1e-9);
}

TEST(Reprojection, Chi2IsInfiniteBehindTheCameraAndForNonsense) {
  PixelObservation keypoint = TestKeypoint(true);
  const double nan = std::nan("");
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, -1), {0, 0, 0}, {1, 1, 1e-300}, {nan, 0, 1}, {0, 0, nan}, {1e300, 0, 1}}) {
    EXPECT_TRUE(std::isinf(ReprojectionChi2(TestCamera(), keypoint, point))) << point.transpose();
  }
  keypoint.pixel.x() = nan;
  EXPECT_TRUE(std::isinf(ReprojectionChi2(TestCamera(), keypoint, kPoint)));
}

TEST(Reprojection, InlierThresholdDependsOnDepth) {
  EXPECT_TRUE(IsInlier(TestKeypoint(false), 5.99));
  EXPECT_FALSE(IsInlier(TestKeypoint(false), 6.0));
  EXPECT_TRUE(IsInlier(TestKeypoint(true), 7.81));
  EXPECT_FALSE(IsInlier(TestKeypoint(true), 7.82));
  EXPECT_FALSE(IsInlier(TestKeypoint(true), std::nan("")));
}

}  // namespace
}  // namespace rds
