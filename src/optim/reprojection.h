// Reprojection residual of bundle adjustment and its derivatives, for any solver.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "optim/observation.h"

namespace rds {

// A pose parametrised by an increment (translation in metres, rotation in radians) about where it started:
// rotation = exp(increment.tail<3>) initial.rotation, translation = initial.translation + increment.head<3>.
// Update() after each change of `increment`. Not thread-safe.
struct PoseVariable {
  Rigid3 initial_camera_from_world;
  std::array<double, 6> increment{};
  // As of the last Update.
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  Eigen::Matrix3d left_jacobian;  // of the rotation's increment

  explicit PoseVariable(const Rigid3& initial) : initial_camera_from_world(initial) { Update(); }

  void Update() {
    const Eigen::Map<const Eigen::Matrix<double, 6, 1>> delta(increment.data());
    rotation = (ExpSo3(delta.tail<3>()) * initial_camera_from_world.rotation).toRotationMatrix();
    translation = initial_camera_from_world.translation + delta.head<3>();
    left_jacobian = LeftJacobianSo3(delta.tail<3>());
  }
  // The very bytes of the start if the increment is zero.
  [[nodiscard]] Rigid3 Value() const {
    if (increment == std::array<double, 6>{}) {
      return initial_camera_from_world;
    }
    return Perturb(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(increment.data()), initial_camera_from_world);
  }
};

// A keypoint ready for evaluation.
struct ReprojectionTarget {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double right_x = 0;
  double scale = 0;  // weight * sqrt(inverse_sigma2); 0 = does not take part

  ReprojectionTarget() = default;
  explicit ReprojectionTarget(const PixelObservation& keypoint)
      : pixel(keypoint.pixel), right_x(keypoint.right_x), scale(keypoint.weight * std::sqrt(keypoint.inverse_sigma2)) {}
};

// Points nearer than this (metres) count as behind the camera.
inline constexpr double kMinReprojectionDepth_m = 1e-6;

// Residual scale * (measured - projected) of Rows = 2 (x, y) or 3 (x, y, right_x) and, where not null, its row-major
// derivatives by the pose's increment (Rows x 6) and by the point (Rows x 3). A point behind the camera is taken to be
// just in front of it, which makes the residual huge. `point` is in the world.
template <int Rows>
void EvaluateReprojection(const PinholeCamera& camera, const PoseVariable& pose, const ReprojectionTarget& target,
                          const double* point, double* residual, double* by_increment, double* by_point) {
  static_assert(Rows == 2 || Rows == 3);
  if (target.scale == 0) {
    std::fill_n(residual, Rows, 0.0);
    if (by_increment != nullptr) {
      std::fill_n(by_increment, Rows * 6, 0.0);
    }
    if (by_point != nullptr) {
      std::fill_n(by_point, Rows * 3, 0.0);
    }
    return;
  }
  const Eigen::Vector3d rotated = pose.rotation * Eigen::Map<const Eigen::Vector3d>(point);
  const Eigen::Vector3d in_camera = rotated + pose.translation;
  const double inverse_z = 1.0 / std::max(in_camera.z(), kMinReprojectionDepth_m);
  const double x = in_camera.x() * inverse_z;
  const double y = in_camera.y() * inverse_z;
  const double u = camera.fx * x + camera.cx;
  const double v = camera.fy * y + camera.cy;
  residual[0] = target.scale * (target.pixel.x() - u);
  residual[1] = target.scale * (target.pixel.y() - v);
  if constexpr (Rows == 3) {
    residual[2] = target.scale * (target.right_x - (u - camera.Bf() * inverse_z));
  }
  if (by_increment == nullptr && by_point == nullptr) {
    return;
  }

  const double gx = -target.scale * camera.fx * inverse_z;
  const double gy = -target.scale * camera.fy * inverse_z;
  Eigen::Matrix<double, Rows, 3> by_camera_point;
  by_camera_point.row(0) << gx, 0, -gx * x;
  by_camera_point.row(1) << 0, gy, -gy * y;
  if constexpr (Rows == 3) {
    by_camera_point.row(2) << gx, 0, -gx * x - target.scale * camera.Bf() * inverse_z * inverse_z;
  }
  if (by_point != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Rows, 3, Eigen::RowMajor>>(by_point).noalias() = by_camera_point * pose.rotation;
  }
  if (by_increment != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Rows, 6, Eigen::RowMajor>> jacobian(by_increment);
    jacobian.template leftCols<3>() = by_camera_point;
    Eigen::Matrix<double, Rows, 3> by_angle;  // g . (w x q) = (q x g) . w
    for (int row = 0; row < Rows; ++row) {
      by_angle.row(row) = rotated.cross(by_camera_point.row(row).transpose()).transpose();
    }
    jacobian.template rightCols<3>().noalias() = by_angle * pose.left_jacobian;
  }
}

}  // namespace rds
