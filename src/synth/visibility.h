// SPDX-License-Identifier: Apache-2.0
// Visible surfaces by inverse depth: rectangles by spans, capsules by solving for the ray.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "synth/scene.h"

namespace rds::synthetic {

// value = a * column + b * row + c.
struct Linear {
  double a = 0;
  double b = 0;
  double c = 0;
  [[nodiscard]] double At(double column, double row) const { return a * column + b * row + c; }
};

// A grid of sample points in the image plane; its sample (column, row) is the ray (ray_x, ray_y, 1) of the camera
// frame.
struct SampleGrid {
  int width = 0;
  int height = 0;
  double x0 = 0;  // ray_x = x0 + step_x * column
  double y0 = 0;
  double step_x = 0;
  double step_y = 0;

  // `factor` x `factor` samples a pixel, centered in its parts; 1 gives the pixels' centers.
  SampleGrid(const PinholeCamera& camera, int factor);
  // The linear function with the value ray . v at each sample.
  [[nodiscard]] Linear Dot(const Eigen::Vector3d& v) const;
};

// A rectangle seen from a camera: w is the inverse depth, s / w and t / w are the place on it in meters.
struct ProjectedQuad {
  Linear s, t, w;
  bool visible = false;  // the camera is on its front side
};

// A capsule in the camera's frame: local = -center + ray * depth in the frame where it is the unit capsule.
struct ProjectedCapsule {
  Eigen::Matrix3d local_from_camera;
  Eigen::Vector3d center;  // in local units
  double half_length = 0;

  // Depth where the ray (x, y, 1) first meets it, 0 if it does not.
  [[nodiscard]] double Depth(double ray_x, double ray_y) const;
};

ProjectedQuad Project(const Quad& quad, const SampleGrid& grid, const Rigid3& camera_from_world);
ProjectedCapsule Project(const Capsule& capsule, const Rigid3& camera_from_world);

// The nearest surface at each sample: index of a quad, or number of quads + index of a capsule; kNothing if none.
struct VisibilityBuffer {
  static constexpr std::uint16_t kNothing = 65535;
  std::vector<float> inverse_depth;  // row-major, 0 = nothing
  std::vector<std::uint16_t> surface;
};

VisibilityBuffer ComputeVisibility(const Scene& scene, const std::vector<ProjectedQuad>& quads,
                                   const std::vector<ProjectedCapsule>& capsules, const SampleGrid& grid,
                                   const Rigid3& camera_from_world);

}  // namespace rds::synthetic
