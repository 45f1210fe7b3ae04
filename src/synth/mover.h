// SPDX-License-Identifier: Apache-2.0
// A person in the room: on a seat or on a walk.
#pragma once

#include <vector>

#include "synth/person.h"
#include "synth/room.h"

namespace rds::synthetic {

// A walk of straight legs: stands and turns from the arrival before until `departure_s`, then walks to `to`.
struct Leg {
  double departure_s = 0;
  double arrival_s = 0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double walked_before_m = 0;
  double heading = 0;  // radians from x to y
};

inline constexpr double kTurn_s = 0.45;  // time to turn round between two legs
inline constexpr double kRamp_s = 0.8;   // from standing to full speed, and back: two steps

// Share of the way of a leg that is behind the walker: even acceleration, full speed, even deceleration. A leg of
// length l at full speed v takes l / v + kRamp_s.
double ShareWalked(const Leg& leg, double time_s);

// Where a walker is at a time; before the first leg at its start, after the last at its end.
Stance StanceAt(const std::vector<Leg>& legs, double time_s);

// One person with a fixed seat or a walk. Immutable.
class Mover {
 public:
  Mover(std::uint64_t seed, const Seat& seat);
  Mover(std::uint64_t seed, std::vector<Leg> legs);

  // All body parts at a time.
  [[nodiscard]] std::vector<Capsule> At(double time_s) const;
  // Place on the floor plan.
  [[nodiscard]] Eigen::Vector2d PlaceAt(double time_s) const;

 private:
  Person person_;
  Seat seat_;
  std::vector<Leg> legs_;  // empty: sits
};

}  // namespace rds::synthetic
