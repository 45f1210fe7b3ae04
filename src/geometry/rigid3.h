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

// A small motion of the frame that a transform leads to, (translation in meters, rotation vector in radians): the one
// tangent of SE(3) that this project uses. Residuals, Jacobians and information matrices of poses are in it.
using Tangent6 = Eigen::Matrix<double, 6, 1>;
using Information6 = Eigen::Matrix<double, 6, 6>;  // inverse covariance of a Tangent6

// Moves a pose from the left: x_in_b <- exp(delta.tail<3>) x_in_b + delta.head<3>. To first order the point moves by
// delta.head<3> + delta.tail<3> x x_in_b.
Rigid3 Retract(const Tangent6& delta, const Rigid3& b_from_a);

// Angle of a rotation in radians, in [0, pi].
double AngleOf(const Eigen::Quaterniond& q);

}  // namespace rds
