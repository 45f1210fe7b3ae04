#include "testing/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rds::synthetic {
namespace {

Eigen::Vector3d IntoBox(const Box& box, const Eigen::Vector3d& vector) {
  const double cosine = std::cos(box.yaw);
  const double sine = std::sin(box.yaw);
  return {cosine * vector.x() + sine * vector.y(), cosine * vector.y() - sine * vector.x(), vector.z()};
}

}  // namespace

double Box::Distance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = IntoBox(*this, point - center);
  return (local.cwiseAbs() - half_size).cwiseMax(0.0).norm();
}

bool Box::Meets(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double minimum, double maximum) const {
  const Eigen::Vector3d from = IntoBox(*this, origin - center);
  const Eigen::Vector3d along = IntoBox(*this, direction);
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1.0 / (std::abs(along[axis]) < 1e-12 ? 1e-12 : along[axis]);
    const double a = (-half_size[axis] - from[axis]) * inverse;
    const double b = (half_size[axis] - from[axis]) * inverse;
    minimum = std::max(minimum, std::min(a, b));
    maximum = std::min(maximum, std::max(a, b));
  }
  return minimum < maximum;
}

double Distance(const Capsule& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d lengths = capsule.axes.colwise().norm().transpose();
  const Eigen::Vector3d offset = point - capsule.center;
  Eigen::Vector3d local;
  for (int axis = 0; axis < 3; ++axis) {
    local[axis] = capsule.axes.col(axis).dot(offset) / (lengths[axis] * lengths[axis]);
  }
  local.z() -= std::clamp(local.z(), -capsule.half_length, capsule.half_length);
  return std::max(0.0, (local.norm() - 1.0) * lengths.minCoeff());
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
