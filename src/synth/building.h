// SPDX-License-Identifier: Apache-2.0
// A building: a ring of corridors with rooms along it, and a way round.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/rigid3.h"
#include "synth/mover.h"
#include "synth/room.h"

namespace rds::synthetic {

// Corridors about a rectangle, 64 m once round their middle, with eight rooms that open to them on the outside. World
// frame: z up, origin on the floor in the middle, meters. One stretch of three meters has no texture at all.
struct BuildingLook {
  bool alike = false;       // all rooms, and all doors, look the same in shape and color
  std::uint64_t decor = 0;  // pictures, furniture, the rooms' wallpaper; corridors, floors and doors are the seed's
};
// `texel_scale` as in BuildRoom.
Room BuildBuilding(std::uint64_t seed, const BuildingLook& look, double texel_scale);

// Where a walk along the corridors' middle is after so many meters, counterclockwise from the middle of one of them;
// corners are rounded. `heading`: the direction of the way, radians from x to y.
struct RingPlace {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0;
};
RingPlace RingAt(double way_m);
double RingLength();  // once round, meters

// A camera that is carried along the ring at 0.8 m/s and looks about; `back`: the other way round and on the other side
// of the corridor. World from camera (x right, y down, z forward), without a hand's tremor.
Rigid3 RingGaze(double time_s, bool back);

// People who walk along the corridors against the camera's way, in and out of its view.
std::vector<Mover> PlanRingWalkers(int count, double duration_s, std::uint64_t seed);

}  // namespace rds::synthetic
