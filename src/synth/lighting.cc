// SPDX-License-Identifier: Apache-2.0
#include "synth/lighting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rds::synthetic {
namespace {

constexpr double kGrid_m = 0.12;         // spacing of the points where light is computed
constexpr double kAmbientReach_m = 0.7;  // things farther away do not dim ambient light
constexpr int kAmbientRays = 14;
constexpr int kLightSamples = 3;  // along each side of a light

}  // namespace

Lighting::Lighting(std::vector<Box> boxes, std::vector<AreaLight> lights, const Eigen::Vector3d& room_half)
    : boxes_(std::move(boxes)), lights_(std::move(lights)), room_half_(room_half) {}

bool Lighting::Blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double maximum) const {
  return std::any_of(boxes_.begin(), boxes_.end(),
                     [&](const Box& box) { return box.Meets(origin, direction, 0.0, maximum); });
}

double Lighting::Direct(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  double sum = 0;
  for (const AreaLight& light : lights_) {
    const Eigen::Vector3d facing = light.u.cross(light.v).normalized();
    for (int i = 0; i < kLightSamples * kLightSamples; ++i) {
      const double a = 2.0 * (i % kLightSamples + 0.5) / kLightSamples - 1.0;
      const double b = 2.0 * (i / kLightSamples + 0.5) / kLightSamples - 1.0;
      const Eigen::Vector3d to_light = light.center + a * light.u + b * light.v - point;
      const double distance = to_light.norm();
      const double cosines = to_light.dot(normal) * std::abs(to_light.dot(facing)) / (distance * distance);
      if (cosines > 0 && !Blocked(point, to_light, 0.999)) {
        sum += light.power * cosines / (0.6 + distance * distance) / (kLightSamples * kLightSamples);
      }
    }
  }
  return sum;
}

double Lighting::Ambient(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const Eigen::Vector3d helper = std::abs(normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d side = normal.cross(helper).normalized();
  const Eigen::Vector3d other = normal.cross(side);
  double open = 0;
  for (int i = 0; i < kAmbientRays; ++i) {  // cosine-weighted spiral over the half sphere
    const double radius = std::sqrt((i + 0.5) / kAmbientRays);
    const double angle = 2.399963 * i;
    const Eigen::Vector3d ray =
        radius * (std::cos(angle) * side + std::sin(angle) * other) + std::sqrt(1.0 - radius * radius) * normal;
    double reach = kAmbientReach_m;
    for (int axis = 0; axis < 2; ++axis) {
      reach = std::min(reach, (room_half_[axis] - std::copysign(point[axis], point[axis] * ray[axis])) /
                                  std::max(std::abs(ray[axis]), 1e-9));
    }
    reach = std::min(reach, (ray.z() > 0 ? room_half_.z() - point.z() : point.z()) / std::max(std::abs(ray.z()), 1e-9));
    const double share = Blocked(point, ray, kAmbientReach_m) ? 0.35 : std::max(reach, 0.0) / kAmbientReach_m;
    open += 0.4 + 0.6 * std::min(share, 1.0);
  }
  return open / kAmbientRays;
}

double Lighting::At(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const double bounce = 0.5 - 0.1 * normal.z();  // the floor throws light up
  const double light = bounce * Ambient(point, normal) + Direct(point, normal);
  return light < 0.9 ? light : 0.9 + 0.35 * (1.0 - std::exp(-(light - 0.9) / 0.35));
}

void Lighting::Apply(const Quad& quad, Canvas& canvas) const {
  const int columns = std::max(2, static_cast<int>(std::ceil(quad.width / kGrid_m)) + 1);
  const int rows = std::max(2, static_cast<int>(std::ceil(quad.height / kGrid_m)) + 1);
  const Eigen::Vector3d normal = quad.Normal();
  std::vector<double> grid;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      // Points on the very border would lie in a neighboring solid.
      const double s = std::clamp(quad.width * column / (columns - 1), 0.01, quad.width - 0.01);
      const double t = std::clamp(quad.height * row / (rows - 1), 0.01, quad.height - 0.01);
      grid.push_back(At(quad.corner + s * quad.right + t * quad.down + 0.004 * normal, normal));
    }
  }
  for (int y = 0; y < canvas.height(); ++y) {
    const double at_y = (y + 0.5) / canvas.height() * (rows - 1);
    const int row = static_cast<int>(at_y);
    const double share_y = at_y - row;
    for (int x = 0; x < canvas.width(); ++x) {
      const double at_x = (x + 0.5) / canvas.width() * (columns - 1);
      const int column = static_cast<int>(at_x);
      const double share_x = at_x - column;
      const double* cell = grid.data() + static_cast<std::ptrdiff_t>(row) * columns + column;
      const double top = cell[0] + share_x * (cell[1] - cell[0]);
      const double bottom = cell[columns] + share_x * (cell[columns + 1] - cell[columns]);
      canvas.At(x, y) = static_cast<float>(top + share_y * (bottom - top)) * canvas.At(x, y);
    }
  }
}

}  // namespace rds::synthetic
