#include "testing/mover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/random.h"

namespace rds::synthetic {
namespace {

constexpr double kTurn_s = 0.45;        // time to turn round between two legs
constexpr double kBodyRadius_m = 0.27;  // kept free of furniture about a walker
constexpr double kPersonal_m = 0.65;    // distance between two people
constexpr double kStep_s = 0.15;        // of the checks along a leg
constexpr double kWorst = -std::numeric_limits<double>::infinity();
constexpr double kCameraStep_s = 0.05;    // of the table of camera poses
constexpr double kStartDistance_m = 1.8;  // nearer people enter from outside the view
constexpr int kCandidates = 90;

// What a scenario wants of its walkers.
struct Wish {
  double nearest_m = 0;  // liked distances from the camera
  double farthest_m = 0;
  double keep_off_m = 0;  // never nearer than this
};

// Every second walker keeps farther off, so that some hide others.
Wish WishOf(SyntheticScenario scenario, int walker) {
  if (scenario == SyntheticScenario::kCrossing) {
    return {0.85, 1.3, 0.76};
  }
  return walker % 2 == 0 ? Wish{1.0, 2.0, 0.85} : Wish{1.5, 3.0, 0.95};
}

// A body's distance and sideways tangent in the camera's view.
struct Sight {
  double distance_m = 0;
  double tangent = 0;
  bool visible = false;
};

class Planner {
 public:
  Planner(const Room& room, const CameraPath& camera, double duration_s, Wish wish)
      : room_(room), duration_s_(duration_s), wish_(wish) {
    for (double t = 0; t < duration_s + 6.0; t += kCameraStep_s) {
      world_from_camera_.push_back(camera.WorldFromCamera(t));
    }
  }

  [[nodiscard]] Leg Start(const std::vector<Mover>& others, Random& random) const;
  // The best of some legs that could follow, with its score.
  [[nodiscard]] std::pair<Leg, double> Next(const Leg& last, const std::vector<Mover>& others, int candidates,
                                            Random& random) const;
  std::vector<Leg> PlanWalk(const std::vector<Mover>& others, Random& random) const;
  // How well a seat is seen; negative if the camera comes too near.
  [[nodiscard]] double SeatScore(const Seat& seat) const;

 private:
  [[nodiscard]] const Rigid3& CameraAt(double time_s) const;
  [[nodiscard]] Sight SightOf(const Eigen::Vector2d& place, double time_s) const;
  // How good it is to be there; negative, and the more so the worse, if one should not.
  [[nodiscard]] double PlaceScore(const Eigen::Vector2d& place, double time_s, const std::vector<Mover>& others) const;
  [[nodiscard]] double LegScore(const Leg& leg, const std::vector<Mover>& others) const;
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
    if (room_.FloorClearance(from + (to - from) * i / steps) < kBodyRadius_m) {
      return false;
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

double Planner::LegScore(const Leg& leg, const std::vector<Mover>& others) const {
  double sum = 0;
  double worst = 0;
  int count = 0;
  for (double t = leg.departure_s - kTurn_s; t < leg.arrival_s + 2.0 * kTurn_s; t += kStep_s) {
    const double share = std::clamp((t - leg.departure_s) / (leg.arrival_s - leg.departure_s), 0.0, 1.0);
    const double score = PlaceScore(leg.from + share * (leg.to - leg.from), t, others);
    worst = std::min(worst, score);
    sum += score;
    ++count;
  }
  if (worst < 0) {
    return worst;
  }
  const double start = SightOf(leg.from, leg.departure_s).tangent;
  const double end = SightOf(leg.to, leg.arrival_s).tangent;
  return sum / count + 0.35 * std::min(1.0, std::abs(start - end));  // walking across is worth more than towards
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
    const double close = sight.visible ? std::max(0.0, kStartDistance_m - sight.distance_m) : 0.0;
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
  const double speed = random.Uniform(0.8, 1.15);
  Leg best = leg;  // stays where it is if there is nowhere to go
  best.to = leg.from;
  best.arrival_s = leg.departure_s + 0.3;
  best.heading = last.heading;
  double best_score = LegScore(best, others) - 0.5;
  for (int i = 0; i < candidates; ++i) {
    leg.to = Candidate(last.arrival_s + 2.0, random);
    const Eigen::Vector2d way = leg.to - leg.from;
    leg.arrival_s = leg.departure_s + way.norm() / speed;
    leg.heading = std::atan2(way.y(), way.x());
    const bool possible = way.norm() > 0.5 && way.norm() < 4.0 && IsFree(leg.from, leg.to);
    const double score = possible ? LegScore(leg, others) : kWorst;
    if (score > best_score) {
      best_score = score;
      best = leg;
    }
  }
  return {best, best_score};
}

std::vector<Leg> Planner::PlanWalk(const std::vector<Mover>& others, Random& random) const {
  std::vector<Leg> legs{Start(others, random)};
  while (legs.back().arrival_s < duration_s_) {
    legs.push_back(Next(legs.back(), others, kCandidates, random).first);
  }
  return legs;
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

}  // namespace

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
  const double share = duration_s > 0 ? std::clamp((time_s - next->departure_s) / duration_s, 0.0, 1.0) : 0.0;
  const double length = (next->to - next->from).norm();
  stance.position = next->from + share * (next->to - next->from);
  stance.distance_m = next->walked_before_m + share * length;
  stance.effort = std::clamp(std::min(share, 1.0 - share) * duration_s / 0.25, 0.0, 1.0);
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

std::vector<Mover> PlanMovers(SyntheticScenario scenario, int count, const Room& room, const CameraPath& camera,
                              double duration_s, std::uint64_t seed) {
  const Planner sitters(room, camera, duration_s, WishOf(scenario, 0));
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
  for (int i = 0; i < count; ++i) {
    Random random(seed * 0xD1B54A32D192ED03ULL + 0x3017EULL + static_cast<std::uint64_t>(i));
    const std::uint64_t looks = random.Bits();
    if (i < sitting && static_cast<std::size_t>(i) < seats.size()) {
      movers.emplace_back(looks, seats[static_cast<std::size_t>(i)].second);
    } else {
      const Planner planner(room, camera, duration_s, WishOf(scenario, i));
      movers.emplace_back(looks, planner.PlanWalk(movers, random));
    }
  }
  return movers;
}

}  // namespace rds::synthetic
