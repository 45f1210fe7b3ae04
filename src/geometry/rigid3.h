// SPDX-License-Identifier: Apache-2.0
// Rigid transforms of 3-space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rds {

// x_in_b = rotation * x_in_a + translation, named b_from_a; translation in meters. `c_from_a = c_from_b * b_from_a`.
// The quaternion is kept at unit norm by every function here. A value: safe to copy between threads.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Matrix3d RotationMatrix() const { return rotation.toRotationMatrix(); }
  [[nodiscard]] Rigid3 Inverse() const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }
};

Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a);

// Skew-symmetric matrix [w]x with [w]x v = w x v.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& w);
// exp: so(3) -> SO(3), `w` in radians.
Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& w);
// log: SO(3) -> so(3), norm in [0, pi].
Eigen::Vector3d LogSo3(const Eigen::Quaterniond& q);
// Left Jacobian of SO(3): exp(w + dw) = exp(J dw) exp(w) to first order.
Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& w);

// Applies a small change on the left, decoupled: rotation <- exp(delta.tail<3>) rotation, translation <- translation +
// delta.head<3>. Order (translation in meters, rotation in radians).
Rigid3 Perturb(const Eigen::Matrix<double, 6, 1>& delta, const Rigid3& pose);

// Angle of a rotation in radians, in [0, pi].
double AngleOf(const Eigen::Quaterniond& q);

}  // namespace rds
