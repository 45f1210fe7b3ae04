// SPDX-License-Identifier: Apache-2.0
// The room of the synthetic world: walls, furniture, things on it.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/scene.h"

namespace rds::synthetic {

// A place where a person can sit: on the floor plan, looking along `heading` (radians from x to y).
struct Seat {
  Eigen::Vector2d position;
  double heading = 0;
};

// World frame: z up, origin on the floor in the middle of the room, meters.
struct Room {
  static constexpr double kHalfSize = 3.0;  // in x and in y
  static constexpr double kHeight = 2.6;

  Scene scene;             // lit
  std::vector<Box> boxes;  // all solid furniture, without the shell
  std::vector<Seat> seats;

  // Distance of a point from shell, furniture and things; 0 inside them or outside the room.
  [[nodiscard]] double Clearance(const Eigen::Vector3d& point) const;
  // Distance of a place on the floor from walls and everything up to 2 m above it.
  [[nodiscard]] double FloorClearance(const Eigen::Vector2d& place) const;
};

// `texel_scale` enlarges the textures' texels (1 = 2 to 4 mm), for small images.
Room BuildRoom(std::uint64_t seed, double texel_scale);

}  // namespace rds::synthetic
