// SPDX-License-Identifier: Apache-2.0
#include "synth/mover.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rds::synthetic {

double ShareWalked(const Leg& leg, double time_s) {
  const double duration_s = leg.arrival_s - leg.departure_s;
  if (duration_s <= 0) {
    return 0;
  }
  const double ramp_s = std::min(kRamp_s, 0.5 * duration_s);
  const double done_s = std::clamp(time_s - leg.departure_s, 0.0, duration_s);
  const double begun_s = std::min(done_s, ramp_s);
  const double left_s = std::min(duration_s - done_s, ramp_s);
  // At full speed it takes duration - ramp; each ramp goes half as far as full speed would.
  const double at_full_speed_s = done_s - begun_s + 0.5 * begun_s * begun_s / ramp_s - (ramp_s - left_s) +
                                 0.5 * (ramp_s * ramp_s - left_s * left_s) / ramp_s;
  return at_full_speed_s / (duration_s - ramp_s);
}

Stance StanceAt(const std::vector<Leg>& legs, double time_s) {
  const auto next = std::upper_bound(legs.begin(), legs.end(), time_s,
                                     [](double time, const Leg& leg) { return time < leg.arrival_s; });
  Stance stance;
  if (next == legs.end()) {
    const Leg& last = legs.back();
    stance.position = last.to;
    stance.heading = last.heading;
    stance.distance_m = last.walked_before_m + (last.to - last.from).norm();
    return stance;
  }
  const double duration_s = next->arrival_s - next->departure_s;
  const double share = ShareWalked(*next, time_s);
  const double length = (next->to - next->from).norm();
  stance.position = next->from + share * (next->to - next->from);
  stance.distance_m = next->walked_before_m + share * length;
  const double to_end_s = std::min(time_s - next->departure_s, next->arrival_s - time_s);
  stance.effort = duration_s > 0 ? std::clamp(to_end_s / kRamp_s, 0.0, 1.0) : 0.0;
  stance.heading = next->heading;
  if (next != legs.begin() && time_s < next->departure_s) {
    const double before = std::prev(next)->heading;
    const double turn = std::remainder(stance.heading - before, 2.0 * std::numbers::pi);
    const double done = 1.0 - std::clamp((next->departure_s - time_s) / kTurn_s, 0.0, 1.0);
    stance.heading = before + turn * done * done * (3.0 - 2.0 * done);
  }
  return stance;
}

Mover::Mover(std::uint64_t seed, const Seat& seat) : person_(seed), seat_(seat) {}
Mover::Mover(std::uint64_t seed, std::vector<Leg> legs) : person_(seed), legs_(std::move(legs)) {}

std::vector<Capsule> Mover::At(double time_s) const {
  return legs_.empty() ? person_.Sitting(seat_.position, seat_.heading, time_s)
                       : person_.Walking(StanceAt(legs_, time_s), time_s);
}

Eigen::Vector2d Mover::PlaceAt(double time_s) const {
  return legs_.empty() ? seat_.position : StanceAt(legs_, time_s).position;
}

}  // namespace rds::synthetic
