// SPDX-License-Identifier: Apache-2.0
#include "geometry/distortion.h"

#include <gmock/gmock.h>

#include <utility>

namespace rds {
namespace {

using ::testing::HasSubstr;

PinholeCamera Kinect() {
  PinholeCamera camera{.fx = 517.3, .fy = 516.5, .cx = 318.6, .cy = 255.3};
  camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  return camera;
}

TEST(Distort, FollowsTheModels) {
  PinholeCamera camera = Kinect();
  camera.distortion = {0.1, 0.01, 0.002, 0.003, 0.001, 0.05, 0.004, 0.0005};
  const double x = 0.3;
  const double y = -0.2;
  const double r2 = x * x + y * y;
  const double radial = (1 + 0.1 * r2 + 0.01 * r2 * r2 + 0.001 * r2 * r2 * r2) /
                        (1 + 0.05 * r2 + 0.004 * r2 * r2 + 0.0005 * r2 * r2 * r2);
  const Eigen::Vector2d distorted = Distort(camera, {x, y});
  EXPECT_NEAR(distorted.x(), x * radial + 2 * 0.002 * x * y + 0.003 * (r2 + 2 * x * x), 1e-15);
  EXPECT_NEAR(distorted.y(), y * radial + 0.002 * (r2 + 2 * y * y) + 2 * 0.003 * x * y, 1e-15);
  camera.distortion_model = DistortionModel::kFisheye;
  camera.distortion = {};
  EXPECT_NEAR(Distort(camera, {1, 0}).x(), std::atan(1.0), 1e-15);
  EXPECT_EQ(Distort(camera, {0, 0}), Eigen::Vector2d(0, 0));
}

TEST(DistortionProblem, PassesRealLenses) {
  EXPECT_EQ(DistortionProblem(Kinect()), std::nullopt);
  EXPECT_EQ(DistortionProblem({.fx = 525, .fy = 525, .cx = 320, .cy = 240}), std::nullopt);
  // Azure Kinect, color at 1280 x 720, as its SDK gives it.
  PinholeCamera azure{.width = 1280, .height = 720, .fx = 605.3, .fy = 605.2, .cx = 637.5, .cy = 366.0};
  azure.distortion = {0.465, -2.728, 0.0006, -0.0001, 1.591, 0.344, -2.547, 1.517};
  EXPECT_EQ(DistortionProblem(azure), std::nullopt);
  PinholeCamera fisheye{.fx = 286, .fy = 286, .cx = 320, .cy = 240};
  fisheye.distortion_model = DistortionModel::kFisheye;
  fisheye.distortion = {-0.01, 0.05, -0.04, 0.008};
  EXPECT_EQ(DistortionProblem(fisheye), std::nullopt);
}

TEST(DistortionProblem, FindsCoefficientsInAnotherOrder) {
  PinholeCamera camera = Kinect();
  std::swap(camera.distortion[2], camera.distortion[4]);  // k1, k2, k3, p2, p1
  EXPECT_THAT(DistortionProblem(camera).value_or(""), HasSubstr("folds the image over"));
  camera = Kinect();
  camera.distortion = {5, -40, 0.5, 0.5, 100};
  EXPECT_NE(DistortionProblem(camera), std::nullopt);
  camera.distortion = {1e6, 1e6, 1e3, 1e3, 1e9};
  EXPECT_NE(DistortionProblem(camera), std::nullopt);
  camera.distortion = {-0.5, 0, 0, 0, 0};  // turns round inside the image's corners
  EXPECT_NE(DistortionProblem(camera), std::nullopt);
  camera.distortion = {};
  camera.distortion[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(DistortionProblem(camera), std::nullopt);
}

TEST(DistortionProblem, RefusesViewsThatAPlaneCannotHold) {
  PinholeCamera camera{.fx = 150, .fy = 150, .cx = 320, .cy = 240};
  camera.distortion_model = DistortionModel::kFisheye;
  EXPECT_THAT(DistortionProblem(camera).value_or(""), HasSubstr("80 degrees"));
}

}  // namespace
}  // namespace rds
