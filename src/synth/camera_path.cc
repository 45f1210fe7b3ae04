// SPDX-License-Identifier: Apache-2.0
#include "synth/camera_path.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/random.h"
#include "synth/building.h"

namespace rds::synthetic {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

// Where the camera is, which way it looks and how it is rolled.
struct Gaze {
  Eigen::Vector3d position;
  Eigen::Vector3d forward;
  double roll = 0;
};

double Wave(double time_s, double period_s, double phase = 0) { return std::sin(kTurn * time_s / period_s + phase); }

Eigen::Vector3d Direction(double yaw, double pitch) {
  return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
}

Gaze Orbit(double t) {
  const double angle = std::numbers::pi + kTurn * t / 34.0;
  const double radius = 1.82 + 0.1 * Wave(t, 13);
  const Eigen::Vector3d position(radius * std::cos(angle), radius * std::sin(angle), 1.42 + 0.12 * Wave(t, 9));
  const Eigen::Vector3d target(0.25 * Wave(t, 7.5), 0.3 * Wave(t, 10), 0.85 + 0.15 * Wave(t, 6.5));
  return {position, target - position, 0.05 * Wave(t, 5)};
}

Gaze Loop(double t) {
  const double angle = kTurn * t / 15.0;
  const Eigen::Vector3d position(0.75 * std::cos(angle), 0.75 * std::sin(angle), 1.5 + 0.07 * Wave(t, 6));
  return {position, Direction(angle + 0.12 * Wave(t, 7), -0.16 + 0.08 * Wave(t, 5)), 0.05 * Wave(t, 6)};
}

Gaze Xyz(double t) {
  return {{-1.98 + 0.28 * Wave(t, 8.5), 0.42 * Wave(t, 11), 1.36 + 0.2 * Wave(t, 6.5)},
          Direction(0.06 * Wave(t, 9), -0.2 + 0.04 * Wave(t, 7)),
          0.02 * Wave(t, 5)};
}

Gaze Rpy(double t) {
  return {{-1.95 + 0.05 * Wave(t, 9), 0.06 * Wave(t, 11), 1.4 + 0.04 * Wave(t, 8)},
          Direction(0.42 * Wave(t, 8), -0.17 + 0.2 * Wave(t, 6.2)),
          0.24 * Wave(t, 9.5)};
}

Gaze Halfsphere(double t) {
  const double azimuth = std::numbers::pi + 0.65 * Wave(t, 20);
  const double elevation = 0.46 + 0.25 * Wave(t, 8.5);
  const Eigen::Vector3d focus(0, 0, 0.82);
  const Eigen::Vector3d outward = Direction(azimuth, elevation);
  return {focus + 2.1 * outward, -outward + Eigen::Vector3d(0, 0.05 * Wave(t, 6), 0.05 * Wave(t, 7)),
          0.05 * Wave(t, 6)};
}

Gaze Still(double) { return {{-1.95, 0.1, 1.38}, Direction(-0.03, -0.2), 0}; }

Gaze GazeAt(SyntheticPath path, double t) {
  switch (path) {
    case SyntheticPath::kOrbit:
      return Orbit(t);
    case SyntheticPath::kLoop:
      return Loop(t);
    case SyntheticPath::kXyz:
      return Xyz(t);
    case SyntheticPath::kRpy:
      return Rpy(t);
    case SyntheticPath::kHalfsphere:
      return Halfsphere(t);
    case SyntheticPath::kStatic:
      return Still(t);
    case SyntheticPath::kRing:
    case SyntheticPath::kRingBack: {
      const Rigid3 pose = RingGaze(t, path == SyntheticPath::kRingBack);
      return {pose.translation, pose.rotation * Eigen::Vector3d::UnitZ(), 0};
    }
  }
  throw InvariantError("camera path without a motion");
}

}  // namespace

CameraPath::CameraPath(SyntheticPath path, std::uint64_t seed) : path_(path) {
  Random random(seed ^ 0xCA3E7AULL);
  for (double& phase : phases_) {
    phase = random.Uniform(0, kTurn);
  }
}

double CameraPath::Tremor(std::size_t axis, double time_s) const {
  const double slow = 1.5 + 0.13 * static_cast<double>(axis);
  return Wave(time_s, slow, phases_[2 * axis]) + 0.25 * Wave(time_s, 0.3 * slow, phases_[2 * axis + 1]);
}

Rigid3 CameraPath::WorldFromCamera(double time_s) const {
  const Gaze gaze = GazeAt(path_, time_s);
  const double sway = path_ == SyntheticPath::kStatic ? 0.25 : 1.0;
  const Eigen::Vector3d z = gaze.forward.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  const Eigen::Vector3d tremble(Tremor(0, time_s), Tremor(1, time_s), Tremor(2, time_s));
  const Eigen::Vector3d shift(Tremor(3, time_s), Tremor(4, time_s), Tremor(5, time_s));
  Rigid3 pose;
  pose.rotation =
      (Eigen::Quaterniond(axes) * ExpSo3({0, 0, gaze.roll}) * ExpSo3(sway * 0.5 * kDegree * tremble)).normalized();
  pose.translation = gaze.position + sway * 0.008 * shift;
  return pose;
}

}  // namespace rds::synthetic
