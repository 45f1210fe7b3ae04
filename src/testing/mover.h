// The people of a scenario: who sits where, who walks which way.
#pragma once

#include <vector>

#include "testing/camera_path.h"
#include "testing/person.h"
#include "testing/room.h"

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

// Plans the people of a scenario for `duration_s` so that the camera sees much of them, nobody walks through furniture
// or another person, and nobody comes nearer to the camera than about half a metre. Walks are planned leg by leg: of
// many places to go to, that one is taken which keeps the walker in view at the distance that the scenario wants.
std::vector<Mover> PlanMovers(SyntheticScenario scenario, int count, const Room& room, const CameraPath& camera,
                              double duration_s, std::uint64_t seed);

}  // namespace rds::synthetic
