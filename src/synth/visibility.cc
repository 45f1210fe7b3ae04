// SPDX-License-Identifier: Apache-2.0
#include "synth/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rds::synthetic {
namespace {

constexpr double kSeam_m = 2e-4;  // rectangles are drawn this much larger, so that no gap shows where two meet

// Narrows [first, last] to the columns where the function is not negative.
void Clip(const Linear& function, int row, double& first, double& last) {
  const double rest = function.b * row + function.c;
  if (function.a > 0) {
    first = std::max(first, -rest / function.a);
  } else if (function.a < 0) {
    last = std::min(last, -rest / function.a);
  } else if (rest < 0) {
    last = -1;
  }
}

Linear Combine(const Linear& x, double scale, const Linear& y) {
  return {x.a + scale * y.a, x.b + scale * y.b, x.c + scale * y.c};
}

void DrawQuad(const Quad& quad, const ProjectedQuad& projected, std::uint16_t id, const SampleGrid& grid,
              VisibilityBuffer& buffer) {
  const Linear& w = projected.w;
  const std::array<Linear, 5> inside{
      w,
      Combine(projected.s, kSeam_m, w),
      Combine(projected.t, kSeam_m, w),
      Combine({-projected.s.a, -projected.s.b, -projected.s.c}, quad.width + kSeam_m, w),
      Combine({-projected.t.a, -projected.t.b, -projected.t.c}, quad.height + kSeam_m, w),
  };
  for (int row = 0; row < grid.height; ++row) {
    double first = 0;
    double last = grid.width - 1;
    for (const Linear& function : inside) {
      Clip(function, row, first, last);
    }
    if (!(first <= last)) {
      continue;
    }
    const int begin = static_cast<int>(std::ceil(first));
    const int end = static_cast<int>(std::floor(last)) + 1;
    const auto offset = static_cast<std::ptrdiff_t>(row) * grid.width;
    float* inverse_depth = buffer.inverse_depth.data() + offset;
    std::uint16_t* surface = buffer.surface.data() + offset;
    const auto slope = static_cast<float>(w.a);
    const auto start = static_cast<float>(w.b * row + w.c);
    for (int x = begin; x < end; ++x) {
      const float value = start + slope * static_cast<float>(x);
      const bool nearer = value > inverse_depth[x];
      inverse_depth[x] = nearer ? value : inverse_depth[x];
      surface[x] = nearer ? id : surface[x];
    }
  }
}

// Rows and columns, [begin, end), that can see a capsule.
struct Bounds {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

Bounds BoundsOf(const Capsule& capsule, const SampleGrid& grid, const Rigid3& camera_from_world) {
  Bounds bounds{grid.width, 0, grid.height, 0};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d local((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                ((corner & 4) != 0 ? 1 : -1) * (1 + capsule.half_length));
    const Eigen::Vector3d p = camera_from_world * (capsule.center + capsule.axes * local);
    if (p.z() < 0.05) {
      const bool behind =
          (camera_from_world * capsule.center).z() < -capsule.axes.colwise().norm().sum() * (1 + capsule.half_length);
      return behind ? Bounds{} : Bounds{0, grid.width, 0, grid.height};
    }
    const double x = (p.x() / p.z() - grid.x0) / grid.step_x;
    const double y = (p.y() / p.z() - grid.y0) / grid.step_y;
    bounds.x0 = static_cast<int>(std::clamp(std::floor(x), 0.0, static_cast<double>(bounds.x0)));
    bounds.x1 = static_cast<int>(std::clamp(std::ceil(x) + 1, static_cast<double>(bounds.x1), 1.0 * grid.width));
    bounds.y0 = static_cast<int>(std::clamp(std::floor(y), 0.0, static_cast<double>(bounds.y0)));
    bounds.y1 = static_cast<int>(std::clamp(std::ceil(y) + 1, static_cast<double>(bounds.y1), 1.0 * grid.height));
  }
  return bounds;
}

void DrawCapsule(const ProjectedCapsule& capsule, const Bounds& bounds, std::uint16_t id, const SampleGrid& grid,
                 VisibilityBuffer& buffer) {
  for (int row = bounds.y0; row < bounds.y1; ++row) {
    const double ray_y = grid.y0 + grid.step_y * row;
    for (int column = bounds.x0; column < bounds.x1; ++column) {
      const double depth = capsule.Depth(grid.x0 + grid.step_x * column, ray_y);
      const auto at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(column);
      if (depth > 0 && static_cast<float>(1.0 / depth) > buffer.inverse_depth[at]) {
        buffer.inverse_depth[at] = static_cast<float>(1.0 / depth);
        buffer.surface[at] = id;
      }
    }
  }
}

// Smaller root of a z^2 - 2 b z + c = 0 if it is positive, else 0.
double NearRoot(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0 || a <= 0) {
    return 0;
  }
  return std::max(0.0, (b - std::sqrt(discriminant)) / a);
}

}  // namespace

SampleGrid::SampleGrid(const PinholeCamera& camera, int factor)
    : width(camera.width * factor),
      height(camera.height * factor),
      x0(((0.5 / factor - 0.5) - camera.cx) / camera.fx),
      y0(((0.5 / factor - 0.5) - camera.cy) / camera.fy),
      step_x(1.0 / (factor * camera.fx)),
      step_y(1.0 / (factor * camera.fy)) {}

Linear SampleGrid::Dot(const Eigen::Vector3d& v) const {
  return {v.x() * step_x, v.y() * step_y, v.x() * x0 + v.y() * y0 + v.z()};
}

double ProjectedCapsule::Depth(double ray_x, double ray_y) const {
  const Eigen::Vector3d m = local_from_camera * Eigen::Vector3d(ray_x, ray_y, 1.0);
  const Eigen::Vector3d& q = center;  // hit: |m z - q| = 1, less the segment
  const double a2 = m.x() * m.x() + m.y() * m.y();
  const double b2 = m.x() * q.x() + m.y() * q.y();
  const double c2 = q.x() * q.x() + q.y() * q.y() - 1.0;
  if (half_length > 0) {
    const double side = NearRoot(a2, b2, c2);
    if (side > 0 && std::abs(m.z() * side - q.z()) <= half_length) {
      return side;
    }
    if (b2 * b2 - a2 * c2 < 0) {
      return 0;
    }
  }
  double nearest = 0;
  for (const double cap : {half_length, -half_length}) {
    const double z = q.z() + cap;
    const double hit = NearRoot(a2 + m.z() * m.z(), b2 + m.z() * z, c2 + z * z);
    if (hit > 0 && (nearest == 0 || hit < nearest)) {
      nearest = hit;
    }
    if (half_length == 0) {
      break;
    }
  }
  return nearest;
}

ProjectedQuad Project(const Quad& quad, const SampleGrid& grid, const Rigid3& camera_from_world) {
  const Eigen::Vector3d corner = camera_from_world * quad.corner;
  const Eigen::Vector3d right = camera_from_world.rotation * quad.right;
  const Eigen::Vector3d down = camera_from_world.rotation * quad.down;
  const Eigen::Vector3d normal = camera_from_world.rotation * quad.Normal();
  ProjectedQuad projected;
  const double distance = normal.dot(corner);  // negative if the front side faces the camera
  if (distance > -1e-6) {
    return projected;
  }
  projected.visible = true;
  projected.w = grid.Dot(normal / distance);
  projected.s = grid.Dot(right - right.dot(corner) / distance * normal);
  projected.t = grid.Dot(down - down.dot(corner) / distance * normal);
  return projected;
}

ProjectedCapsule Project(const Capsule& capsule, const Rigid3& camera_from_world) {
  const Eigen::Matrix3d axes = camera_from_world.RotationMatrix() * capsule.axes;
  ProjectedCapsule projected;
  for (int axis = 0; axis < 3; ++axis) {
    projected.local_from_camera.row(axis) = axes.col(axis).transpose() / axes.col(axis).squaredNorm();
  }
  projected.center = projected.local_from_camera * (camera_from_world * capsule.center);
  projected.half_length = capsule.half_length;
  return projected;
}

VisibilityBuffer ComputeVisibility(const Scene& scene, const std::vector<ProjectedQuad>& quads,
                                   const std::vector<ProjectedCapsule>& capsules, const SampleGrid& grid,
                                   const Rigid3& camera_from_world) {
  const auto samples = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
  VisibilityBuffer buffer{std::vector<float>(samples, 0.0F),
                          std::vector<std::uint16_t>(samples, VisibilityBuffer::kNothing)};
  for (std::size_t i = 0; i < quads.size(); ++i) {
    if (quads[i].visible) {
      DrawQuad(scene.quads[i], quads[i], static_cast<std::uint16_t>(i), grid, buffer);
    }
  }
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    DrawCapsule(capsules[i], BoundsOf(scene.capsules[i], grid, camera_from_world),
                static_cast<std::uint16_t>(quads.size() + i), grid, buffer);
  }
  return buffer;
}

}  // namespace rds::synthetic
