// SPDX-License-Identifier: Apache-2.0
// What a synthetic scene is made of: textured rectangles and squashed capsules, and boxes for checks and shadows.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "synth/texture.h"

namespace rds::synthetic {

// A textured rectangle: points corner + s * right + t * down, s in [0, width], t in [0, height]. Seen from the side
// that `normal` = down x right points to. `right` and `down` are orthogonal unit vectors; world frame, meters.
struct Quad {
  Eigen::Vector3d corner;
  Eigen::Vector3d right;
  Eigen::Vector3d down;
  double width = 0;
  double height = 0;
  std::shared_ptr<const Texture> texture;
  bool is_mover = false;

  [[nodiscard]] Eigen::Vector3d Normal() const { return down.cross(right); }
};

// The image of a capsule |(x, y, z - clamp(z, -h, h))| = 1 under point_in_world = center + axes * (x, y, z). With h = 0
// an ellipsoid, with axes of different lengths a flattened body. The texture's x goes round the z axis from the -x side
// over -y, its y goes from +z to -z. Lit by its normal.
struct Capsule {
  Eigen::Vector3d center;
  Eigen::Matrix3d axes;                    // orthogonal columns, lengths in meters
  double half_length = 0;                  // h, in units of the z axis
  std::shared_ptr<const Texture> texture;  // wraps in x
  bool is_mover = false;
};

// An upright box turned by `yaw` about z: the solid parts of room and furniture.
struct Box {
  Box(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size, double yaw);

  // Distance of a point from the box, 0 inside.
  [[nodiscard]] double Distance(const Eigen::Vector3d& point) const;
  // Whether the ray from `origin` along `direction` meets the box at a parameter in (minimum, maximum).
  [[nodiscard]] bool Meets(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double minimum,
                           double maximum) const;

  Eigen::Vector3d center;
  Eigen::Vector3d half_size;
  Eigen::Vector3d x_axis;  // in the world

 private:
  [[nodiscard]] Eigen::Vector3d IntoBox(const Eigen::Vector3d& vector) const;
};

// Distance of a point from a capsule, 0 inside; exact for round ones, otherwise a lower bound (that of its box at
// least).
double Distance(const Capsule& capsule, const Eigen::Vector3d& point);

// A capsule along the segment from `a` to `b` with rounded ends about these points; `radius_side` is the half width
// along `side` made orthogonal to the segment, `radius_other` that across both.
Capsule MakeLimb(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& side, double radius_side,
                 double radius_other, std::shared_ptr<const Texture> texture);

struct Scene {
  std::vector<Quad> quads;
  std::vector<Capsule> capsules;
};

}  // namespace rds::synthetic
