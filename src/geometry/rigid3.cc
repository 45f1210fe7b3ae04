// SPDX-License-Identifier: Apache-2.0
#include "geometry/rigid3.h"

#include <cmath>

namespace rds {

Rigid3 Rigid3::Inverse() const {
  const Eigen::Quaterniond inverse = rotation.conjugate();
  return {inverse, -(inverse * translation)};
}

Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a) {
  return {(c_from_b.rotation * b_from_a.rotation).normalized(),
          c_from_b.rotation * b_from_a.translation + c_from_b.translation};
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& w) {
  Eigen::Matrix3d m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const double half = 0.5 * angle;
  const double scale = angle < 1e-8 ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  return Eigen::Quaterniond(std::cos(half), scale * w.x(), scale * w.y(), scale * w.z()).normalized();
}

Eigen::Vector3d LogSo3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;  // q and -q are the same rotation; take the shorter way
  const double sine = q.vec().norm();
  if (sine < 1e-10) {
    return 2.0 * sign * q.vec();
  }
  return (2.0 * std::atan2(sine, sign * q.w()) / sine) * sign * q.vec();
}

Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm();
  const Eigen::Matrix3d cross = CrossMatrix(w);
  if (angle2 < 1e-8) {
    return Eigen::Matrix3d::Identity() + 0.5 * cross + cross * cross / 6.0;
  }
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle2 * cross +
         (angle - std::sin(angle)) / (angle2 * angle) * cross * cross;
}

Rigid3 Retract(const Tangent6& delta, const Rigid3& b_from_a) {
  return Rigid3{ExpSo3(delta.tail<3>()), delta.head<3>()} * b_from_a;
}

double AngleOf(const Eigen::Quaterniond& q) { return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w())); }

}  // namespace rds
