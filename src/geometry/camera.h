// SPDX-License-Identifier: Apache-2.0
// Pinhole RGB-D camera.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace rds {

// Of a lens, with the coefficients in OpenCV's order.
enum class DistortionModel : std::uint8_t {
  kBrownConrady,  // k1, k2, p1, p2, k3, and k4, k5, k6 of the rational model ("plumb_bob", "rational_polynomial")
  kFisheye,       // k1, k2, k3, k4 of the equidistant model (Kannala-Brandt)
};

// How far a measured depth may be off at a corner: standard deviation = constant + quadratic * depth^2. Sensors that
// triangulate (structured light, stereo) have the square (Khoshelham and Oude Elberink, Sensors 2012), time of flight
// nearly none of it. The default is that of a first-generation Kinect, measured by the poses that it leads to: twice
// what it scatters by on a plane.
struct DepthNoiseModel {
  double constant_m = 0.002;
  double quadratic_per_m = 0.004;

  [[nodiscard]] double Sigma_m(double depth_m) const { return constant_m + quadratic_per_m * depth_m * depth_m; }
};

// Intrinsics of a registered RGB-D camera. Camera frame: x right, y down, z forward; pixel (0, 0) is the center of the
// top left pixel. A value: safe to copy between threads.
struct PinholeCamera {
  int width = 640;
  int height = 480;
  double fx = 0;  // pixels
  double fy = 0;
  double cx = 0;
  double cy = 0;
  std::array<double, 8> distortion{};  // as its model has them; all 0 = none
  DistortionModel distortion_model = DistortionModel::kBrownConrady;
  double depth_scale = 5000;  // units of a depth image in a meter
  double baseline_m = 0.08;   // between projector and camera: near surfaces throw shadows of this width
  DepthNoiseModel depth_noise{};
  double rolling_shutter_s = 0;  // from the exposure of the first row to that of the last; 0 = all at once
  bool unusual = false;          // its owner says that the numbers are right, although no known camera has them

  [[nodiscard]] bool HasDistortion() const {
    return distortion_model == DistortionModel::kFisheye || distortion != std::array<double, 8>{};
  }
  // Focal length times baseline (pixel meters): the projector sees a depth bf / depth_m pixels aside.
  [[nodiscard]] double Bf() const { return fx * baseline_m; }
  // Undistorted pixel of a point in the camera frame with z > 0.
  [[nodiscard]] Eigen::Vector2d Project(const Eigen::Vector3d& point_in_camera) const {
    return {fx * point_in_camera.x() / point_in_camera.z() + cx, fy * point_in_camera.y() / point_in_camera.z() + cy};
  }
  // Point in the camera frame of an undistorted pixel at a depth.
  [[nodiscard]] Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double depth_m) const {
    return {(pixel.x() - cx) / fx * depth_m, (pixel.y() - cy) / fy * depth_m, depth_m};
  }
};

}  // namespace rds
