// SPDX-License-Identifier: Apache-2.0
// Soft light of a room, computed once and painted into the textures.
#pragma once

#include <vector>

#include "synth/scene.h"

namespace rds::synthetic {

// A light that shines from a rectangle: center + a * u + b * v, a and b in [-1, 1].
struct AreaLight {
  Eigen::Vector3d center;
  Eigen::Vector3d u;
  Eigen::Vector3d v;
  double power = 0;  // of full brightness one meter away, face to face
};

// Brightness of diffuse surfaces: direct light of area lights with soft shadows of boxes, and ambient light dimmed
// where solid things are near. Immutable.
class Lighting {
 public:
  // `room_half` is the room's half width, half depth and height; it stands on z = 0 about the z axis.
  Lighting(std::vector<Box> boxes, std::vector<AreaLight> lights, const Eigen::Vector3d& room_half);

  // Factor for the color of a surface point; about 1 in good light. `normal` is a unit vector.
  [[nodiscard]] double At(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  // Multiplies the light on a rectangle into the picture that will be its texture.
  void Apply(const Quad& quad, Canvas& canvas) const;

 private:
  [[nodiscard]] double Direct(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  [[nodiscard]] double Ambient(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  [[nodiscard]] bool Blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double maximum) const;

  std::vector<Box> boxes_;
  std::vector<AreaLight> lights_;
  Eigen::Vector3d room_half_;
};

}  // namespace rds::synthetic
