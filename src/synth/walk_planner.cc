// SPDX-License-Identifier: Apache-2.0
#include "synth/walk_planner.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "base/random.h"

namespace rds::synthetic {
namespace {

constexpr double kBodyRadius_m = 0.27;  // kept free of furniture about a walker
constexpr double kPersonal_m = 0.65;    // distance between two people
constexpr double kStep_s = 0.15;        // of the checks along a leg
constexpr double kWorst = -std::numeric_limits<double>::infinity();
constexpr double kCameraStep_s = 0.05;    // of the table of camera poses
constexpr double kStartDistance_m = 1.8;  // who walks alone and nearer enters from outside the view
constexpr double kAbreast_m = 0.5;        // between the members of a party
constexpr int kPartySize = 3;
constexpr int kPartyWalks = 16;   // planned for a party, of which it takes the best
constexpr double kJudged_s = 10;  // from the start: what makes a walk the best
constexpr int kCandidates = 90;

// What a scenario wants of its walkers.
struct Wish {
  double nearest_m = 0;  // liked distances from the camera
  double farthest_m = 0;
  double keep_off_m = 0;  // never nearer than this
  double slowest_m_s = 0.8;
  double fastest_m_s = 1.15;
  double shortest_pause_s = 0;  // between two legs
  double longest_pause_s = 0;
};

// Those who walk together stroll and linger before the camera. Of others every second keeps farther off, so that some
// hide others.
Wish WishOf(SyntheticScenario scenario, int walker) {
  if (scenario == SyntheticScenario::kCrossing) {
    return {0.85, 1.3, 0.76};
  }
  if (scenario == SyntheticScenario::kWalking) {
    return {.nearest_m = 0.8,
            .farthest_m = 1.1,
            .keep_off_m = 0.75,
            .slowest_m_s = 0.35,
            .fastest_m_s = 0.7,
            .shortest_pause_s = 0.5,
            .longest_pause_s = 1.5};
  }
  return walker % 2 == 0 ? Wish{1.0, 2.0, 0.85} : Wish{1.5, 3.0, 0.95};
}

// A body's distance and sideways tangent in the camera's view.
struct Sight {
  double distance_m = 0;
  double tangent = 0;
  bool visible = false;
};

// Where those who walk together are, seen from the first of them; the same all the way.
using Party = std::vector<Eigen::Vector2d>;

Party Abreast(int size, double direction) {
  Party party;
  for (int i = 0; i < size; ++i) {
    party.emplace_back(i * kAbreast_m * Eigen::Vector2d(std::cos(direction), std::sin(direction)));
  }
  return party;
}

// The same walk beside it.
std::vector<Leg> Beside(std::vector<Leg> legs, const Eigen::Vector2d& offset) {
  for (Leg& leg : legs) {
    leg.from += offset;
    leg.to += offset;
  }
  return legs;
}

class Planner {
 public:
  Planner(const Room& room, const CameraPath& camera, double duration_s, Wish wish, Party party)
      : room_(room), duration_s_(duration_s), wish_(wish), party_(std::move(party)) {
    for (double t = 0; t < std::max(duration_s, kJudged_s) + 6.0; t += kCameraStep_s) {
      world_from_camera_.push_back(camera.WorldFromCamera(t));
    }
  }

  [[nodiscard]] Leg Start(const std::vector<Mover>& others, Random& random) const;
  // The best of some legs that could follow, with its score.
  [[nodiscard]] std::pair<Leg, double> Next(const Leg& last, const std::vector<Mover>& others, int candidates,
                                            Random& random) const;
  // A walk for the first of the party, with its score.
  [[nodiscard]] std::pair<std::vector<Leg>, double> PlanWalk(const std::vector<Mover>& others, Random& random) const;
  // How well a seat is seen; negative if the camera comes too near.
  [[nodiscard]] double SeatScore(const Seat& seat) const;

 private:
  [[nodiscard]] const Rigid3& CameraAt(double time_s) const;
  [[nodiscard]] Sight SightOf(const Eigen::Vector2d& place, double time_s) const;
  // How good it is to be there; negative, and the more so the worse, if one should not.
  [[nodiscard]] double PlaceScore(const Eigen::Vector2d& place, double time_s, const std::vector<Mover>& others) const;
  // The same for the first of the party there and the others beside it.
  [[nodiscard]] double PartyScore(const Eigen::Vector2d& place, double time_s, const std::vector<Mover>& others) const;
  // Of standing at its start from `begin_s` on, and of walking it.
  [[nodiscard]] double LegScore(const Leg& leg, double begin_s, const std::vector<Mover>& others) const;
  // Whether the whole party can walk there.
  [[nodiscard]] bool IsFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  static Eigen::Vector2d AnyPlace(Random& random) {
    const double x = random.Uniform(-Room::kHalfSize, Room::kHalfSize);
    return {x, random.Uniform(-Room::kHalfSize, Room::kHalfSize)};
  }
  // A place to go to; two of three lie anywhere, the others at a liked distance before the camera.
  Eigen::Vector2d Candidate(double time_s, Random& random) const;

  const Room& room_;
  double duration_s_;
  Wish wish_;
  Party party_;
  std::vector<Rigid3> world_from_camera_;  // each kCameraStep_s
};

const Rigid3& Planner::CameraAt(double time_s) const {
  const auto step = static_cast<std::size_t>(std::max(0.0, time_s / kCameraStep_s));
  return world_from_camera_[std::min(step, world_from_camera_.size() - 1)];
}

Sight Planner::SightOf(const Eigen::Vector2d& place, double time_s) const {
  const Rigid3& world_from_camera = CameraAt(time_s);
  const Eigen::Vector3d p = world_from_camera.Inverse() * Eigen::Vector3d(place.x(), place.y(), 1.1);
  Sight sight;
  sight.distance_m = (world_from_camera.translation.head<2>() - place).norm();
  sight.tangent = p.x() / std::max(p.z(), 0.05);
  sight.visible = p.z() > 0.3 && std::abs(sight.tangent) < 0.6;
  return sight;
}

bool Planner::IsFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const int steps = static_cast<int>((to - from).norm() / 0.1) + 1;
  for (int i = 0; i <= steps; ++i) {
    for (const Eigen::Vector2d& offset : party_) {
      if (room_.FloorClearance(from + offset + (to - from) * i / steps) < kBodyRadius_m) {
        return false;
      }
    }
  }
  return true;
}

double Planner::PlaceScore(const Eigen::Vector2d& place, double time_s, const std::vector<Mover>& others) const {
  const Sight sight = SightOf(place, time_s);
  double lack = std::max(0.0, wish_.keep_off_m - sight.distance_m);
  for (const Mover& other : others) {
    lack = std::max(lack, kPersonal_m - (other.PlaceAt(time_s) - place).norm());
  }
  if (lack > 0) {
    return -lack;
  }
  if (!sight.visible) {
    return 0;
  }
  const double off = std::max({0.0, wish_.nearest_m - sight.distance_m, sight.distance_m - wish_.farthest_m});
  return 0.1 + 0.9 * std::exp(-2.0 * off);
}

double Planner::PartyScore(const Eigen::Vector2d& place, double time_s, const std::vector<Mover>& others) const {
  double sum = 0;
  double worst = 0;
  for (const Eigen::Vector2d& offset : party_) {
    const double score = PlaceScore(place + offset, time_s, others);
    worst = std::min(worst, score);
    sum += score;
  }
  return worst < 0 ? worst : sum / static_cast<double>(party_.size());
}

double Planner::LegScore(const Leg& leg, double begin_s, const std::vector<Mover>& others) const {
  double sum = 0;
  double worst = 0;
  int count = 0;
  for (double t = begin_s; t < leg.arrival_s + 2.0 * kTurn_s; t += kStep_s) {
    const double score = PartyScore(leg.from + ShareWalked(leg, t) * (leg.to - leg.from), t, others);
    worst = std::min(worst, score);
    sum += score;
    ++count;
  }
  if (worst < 0) {
    return worst;
  }
  const double start = SightOf(leg.from, leg.departure_s).tangent;
  const double end = SightOf(leg.to, leg.arrival_s).tangent;
  return sum / count + 0.35 * std::min(1.0, std::abs(start - end));  // walking across is worth more than toward
}

Eigen::Vector2d Planner::Candidate(double time_s, Random& random) const {
  if (random.Index(3) != 0) {
    return AnyPlace(random);
  }
  const double depth = random.Uniform(wish_.nearest_m, wish_.farthest_m);
  const double tangent = random.Uniform(-0.8, 0.8);
  const Eigen::Vector3d p = CameraAt(time_s) * Eigen::Vector3d(tangent * depth, 0, depth);
  return p.head<2>();
}

Leg Planner::Start(const std::vector<Mover>& others, Random& random) const {
  Leg best;
  double best_score = kWorst;
  for (int i = 0; i < kCandidates; ++i) {
    Leg start;
    start.from = start.to = Candidate(0.0, random);
    if (!IsFree(start.from, start.from)) {
      continue;
    }
    const Sight sight = SightOf(start.from, 0.0);
    const bool alone = party_.size() == 1;
    const double close = alone && sight.visible ? std::max(0.0, kStartDistance_m - sight.distance_m) : 0.0;
    const auto [next, score] = Next(start, others, kCandidates / 3, random);
    if (score - close > best_score) {
      best_score = score - close;
      best = start;
      best.heading = next.heading;
    }
  }
  return best;
}

std::pair<Leg, double> Planner::Next(const Leg& last, const std::vector<Mover>& others, int candidates,
                                     Random& random) const {
  Leg leg;
  leg.from = last.to;
  leg.departure_s = last.arrival_s + kTurn_s;
  leg.walked_before_m = last.walked_before_m + (last.to - last.from).norm();
  const double speed = random.Uniform(wish_.slowest_m_s, wish_.fastest_m_s);
  Leg best = leg;  // stays where it is if there is nowhere to go
  best.to = leg.from;
  best.arrival_s = leg.departure_s + 0.3;
  best.heading = last.heading;
  double best_score = LegScore(best, last.arrival_s, others) - 0.5;
  for (int i = 0; i < candidates; ++i) {
    leg.to = Candidate(last.arrival_s + 2.0, random);
    const Eigen::Vector2d way = leg.to - leg.from;
    leg.departure_s = last.arrival_s + kTurn_s + random.Uniform(wish_.shortest_pause_s, wish_.longest_pause_s);
    leg.arrival_s = leg.departure_s + kRamp_s + way.norm() / speed;
    leg.heading = std::atan2(way.y(), way.x());
    const bool possible = way.norm() > 0.5 && way.norm() < 4.0 && IsFree(leg.from, leg.to);
    const double score = possible ? LegScore(leg, last.arrival_s, others) : kWorst;
    if (score > best_score) {
      best_score = score;
      best = leg;
    }
  }
  return {best, best_score};
}

std::pair<std::vector<Leg>, double> Planner::PlanWalk(const std::vector<Mover>& others, Random& random) const {
  std::vector<Leg> legs{Start(others, random)};
  double sum = 0;
  while (legs.back().arrival_s < std::max(duration_s_, kJudged_s)) {
    const double begin_s = legs.back().arrival_s;
    const auto [leg, score] = Next(legs.back(), others, kCandidates, random);
    legs.push_back(leg);
    sum += score * std::max(0.0, std::min(leg.arrival_s, kJudged_s) - begin_s);
  }
  return {legs, sum};
}

double Planner::SeatScore(const Seat& seat) const {
  double sum = 0;
  for (double t = 0; t <= duration_s_; t += kStep_s) {
    const Sight sight = SightOf(seat.position, t);
    if (sight.distance_m < 0.95) {
      return -1;
    }
    sum += sight.visible ? std::exp(-0.5 * std::max(0.0, sight.distance_m - 2.0)) : 0.0;
  }
  return sum * kStep_s / std::max(duration_s_, kStep_s);
}

// Where a person's looks and walk come from.
Random RandomOf(std::uint64_t seed, int person) {
  return Random(seed * 0xD1B54A32D192ED03ULL + 0x3017EULL + static_cast<std::uint64_t>(person));
}

// Adds people who walk together, on the best of some walks; those already there keep theirs.
void AddParty(int first, int size, const std::function<Planner(const Party&)>& planner, std::uint64_t seed,
              std::vector<Mover>& movers) {
  Random random = RandomOf(seed, first);
  const std::uint64_t looks = random.Bits();
  const std::uint64_t way = random.Bits();
  const int walks = size > 1 ? kPartyWalks : 1;
  Party party;
  std::vector<Leg> walk;
  double best_score = kWorst;
  for (int i = 0; i < walks; ++i) {
    Random own(way + static_cast<std::uint64_t>(i));  // so that longer walks begin like shorter ones
    const Party candidate = Abreast(size, i * std::numbers::pi / walks);
    auto [legs, score] = planner(candidate).PlanWalk(movers, own);
    if (score > best_score) {
      best_score = score;
      party = candidate;
      walk = std::move(legs);
    }
  }
  for (int i = 0; i < size; ++i) {
    movers.emplace_back(i == 0 ? looks : RandomOf(seed, first + i).Bits(),
                        Beside(walk, party[static_cast<std::size_t>(i)]));
  }
}

}  // namespace

std::vector<Mover> PlanMovers(SyntheticScenario scenario, int count, const Room& room, const CameraPath& camera,
                              double duration_s, std::uint64_t seed) {
  const Planner sitters(room, camera, duration_s, WishOf(scenario, 0), Abreast(1, 0));
  int sitting = scenario == SyntheticScenario::kSitting ? count : 0;
  if (scenario == SyntheticScenario::kCrowd) {
    sitting = count / 4 + (count > 2 ? 1 : 0);
  }
  std::vector<std::pair<double, Seat>> seats;
  for (const Seat& seat : room.seats) {
    const double score = sitters.SeatScore(seat);
    if (score >= 0) {
      seats.emplace_back(score, seat);
    }
  }
  std::stable_sort(seats.begin(), seats.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Mover> movers;
  const int seated = std::min(sitting, static_cast<int>(seats.size()));
  for (int i = 0; i < seated; ++i) {
    movers.emplace_back(RandomOf(seed, i).Bits(), seats[static_cast<std::size_t>(i)].second);
  }
  const int together = scenario == SyntheticScenario::kWalking ? kPartySize : 1;
  for (int i = seated; i < count; i += together) {
    const auto planner = [&](const Party& party) {
      return Planner(room, camera, duration_s, WishOf(scenario, i), party);
    };
    AddParty(i, std::min(together, count - i), planner, seed, movers);
  }
  return movers;
}

}  // namespace rds::synthetic
