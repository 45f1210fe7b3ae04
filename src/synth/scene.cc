// SPDX-License-Identifier: Apache-2.0
#include "synth/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rds::synthetic {
Box::Box(const Eigen::Vector3d& center_, const Eigen::Vector3d& half_size_, double yaw)
    : center(center_), half_size(half_size_), x_axis(std::cos(yaw), std::sin(yaw), 0) {}

Eigen::Vector3d Box::IntoBox(const Eigen::Vector3d& vector) const {
  return {x_axis.x() * vector.x() + x_axis.y() * vector.y(), x_axis.x() * vector.y() - x_axis.y() * vector.x(),
          vector.z()};
}

double Box::Distance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = IntoBox(point - center);
  return (local.cwiseAbs() - half_size).cwiseMax(0.0).norm();
}

bool Box::Meets(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double minimum, double maximum) const {
  const Eigen::Vector3d from = IntoBox(origin - center);
  const Eigen::Vector3d along = IntoBox(direction);
  for (const int axis : {2, 0, 1}) {
    const double inverse = 1.0 / (std::abs(along[axis]) < 1e-12 ? 1e-12 : along[axis]);
    const double a = (-half_size[axis] - from[axis]) * inverse;
    const double b = (half_size[axis] - from[axis]) * inverse;
    minimum = std::max(minimum, std::min(a, b));
    maximum = std::min(maximum, std::max(a, b));
    if (minimum >= maximum) {
      return false;
    }
  }
  return true;
}

double Distance(const Capsule& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d lengths = capsule.axes.colwise().norm().transpose();
  const Eigen::Vector3d offset = point - capsule.center;
  const Eigen::Vector3d along = capsule.axes.transpose() * offset;  // times the axes' lengths
  const Eigen::Vector3d half = lengths + Eigen::Vector3d(0, 0, capsule.half_length * lengths.z());
  const double from_box = (along.cwiseQuotient(lengths).cwiseAbs() - half).cwiseMax(0.0).norm();
  Eigen::Vector3d local = along.cwiseQuotient(lengths.cwiseAbs2());
  local.z() -= std::clamp(local.z(), -capsule.half_length, capsule.half_length);
  return std::max(from_box, (local.norm() - 1.0) * lengths.minCoeff());
}

Capsule MakeLimb(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& side, double radius_side,
                 double radius_other, std::shared_ptr<const Texture> texture) {
  const double radius_end = std::min(radius_side, radius_other);
  const Eigen::Vector3d along = (a - b).normalized();
  const Eigen::Vector3d x = (side - along * along.dot(side)).normalized();
  Capsule capsule;
  capsule.center = 0.5 * (a + b);
  capsule.axes.col(0) = x * radius_side;
  capsule.axes.col(1) = along.cross(x) * radius_other;
  capsule.axes.col(2) = along * radius_end;
  capsule.half_length = 0.5 * (a - b).norm() / radius_end;
  capsule.texture = std::move(texture);
  return capsule;
}

}  // namespace rds::synthetic
