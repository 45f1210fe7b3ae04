#include "testing/mover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"

namespace rds::synthetic {
namespace {

constexpr double kTurn_s = 0.45;       // time to turn round between two legs
constexpr double kBodyRadius_m = 0.3;  // kept free of furniture about a walker
constexpr double kPersonal_m = 0.65;   // distance between two people
constexpr double kStep_s = 0.15;       // of the checks along a leg
constexpr int kCandidates = 90;

// What a scenario wants of its walkers.
struct Wish {
  double nearest_m = 0;  // liked distances from the camera
  double farthest_m = 0;
  double keep_off_m = 0;  // never nearer than this
};

Wish WishOf(SyntheticScenario scenario) {
  return scenario == SyntheticScenario::kCrossing ? Wish{0.8, 1.4, 0.72} : Wish{1.2, 3.3, 0.95};
}

double Heading(const Leg& leg) { return std::atan2(leg.to.y() - leg.from.y(), leg.to.x() - leg.from.x()); }

// Depth and sideways tangent of a body's middle in the camera's view.
struct Sight {
  double distance_m = 0;
  double tangent = 0;
  bool visible = false;
};

Sight SightOf(const CameraPath& camera, const Eigen::Vector2d& place, double time_s) {
  const Rigid3 world_from_camera = camera.WorldFromCamera(time_s);
  const Eigen::Vector3d p = world_from_camera.Inverse() * Eigen::Vector3d(place.x(), place.y(), 1.1);
  Sight sight;
  sight.distance_m = (world_from_camera.translation.head<2>() - place).norm();
  sight.tangent = p.x() / std::max(p.z(), 0.05);
  sight.visible = p.z() > 0.3 && std::abs(sight.tangent) < 0.6;
  return sight;
}

class Planner {
 public:
  Planner(const Room& room, const CameraPath& camera, double duration_s, Wish wish)
      : room_(room), camera_(camera), duration_s_(duration_s), wish_(wish) {}

  std::vector<Leg> PlanWalk(const std::vector<Mover>& others, Random& random) const;
  // How well a seat is seen; negative if the camera comes too near.
  [[nodiscard]] double SeatScore(const Seat& seat) const;

 private:
  // How good it is to be there; negative if it must not be.
  [[nodiscard]] double PlaceScore(const Eigen::Vector2d& place, double time_s, const std::vector<Mover>& others) const;
  [[nodiscard]] double LegScore(const Leg& leg, const std::vector<Mover>& others) const;
  [[nodiscard]] bool IsFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  static Eigen::Vector2d AnyPlace(Random& random) {
    const double x = random.Uniform(-Room::kHalfSize, Room::kHalfSize);
    return {x, random.Uniform(-Room::kHalfSize, Room::kHalfSize)};
  }
  // Every third place lies at a liked distance before the camera.
  Eigen::Vector2d Candidate(double time_s, Random& random) const;

  const Room& room_;
  const CameraPath& camera_;
  double duration_s_;
  Wish wish_;
};

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
  for (const Mover& other : others) {
    if ((other.PlaceAt(time_s) - place).norm() < kPersonal_m) {
      return -1;
    }
  }
  const Sight sight = SightOf(camera_, place, time_s);
  if (sight.distance_m < wish_.keep_off_m) {
    return -1;
  }
  if (!sight.visible) {
    return 0;
  }
  const double off = std::max({0.0, wish_.nearest_m - sight.distance_m, sight.distance_m - wish_.farthest_m});
  return 0.3 + 0.7 * std::exp(-2.0 * off);
}

double Planner::LegScore(const Leg& leg, const std::vector<Mover>& others) const {
  double sum = 0;
  int count = 0;
  for (double t = leg.departure_s - kTurn_s; t < leg.arrival_s + kTurn_s; t += kStep_s) {
    const double score = PlaceScore(StanceAt({leg}, t).position, t, others);
    if (score < 0) {
      return -1;
    }
    sum += score;
    ++count;
  }
  const double start = SightOf(camera_, leg.from, leg.departure_s).tangent;
  const double end = SightOf(camera_, leg.to, leg.arrival_s).tangent;
  return sum / count + 0.35 * std::min(1.0, std::abs(start - end));  // walking across is worth more than towards
}

Eigen::Vector2d Planner::Candidate(double time_s, Random& random) const {
  if (random.Index(3) != 0) {
    return AnyPlace(random);
  }
  const double depth = random.Uniform(wish_.nearest_m, wish_.farthest_m);
  const double tangent = random.Uniform(-0.8, 0.8);
  const Rigid3 world_from_camera = camera_.WorldFromCamera(time_s);
  const Eigen::Vector3d p = world_from_camera * Eigen::Vector3d(tangent * depth, 0, depth);
  return p.head<2>();
}

std::vector<Leg> Planner::PlanWalk(const std::vector<Mover>& others, Random& random) const {
  Leg first;
  double best = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4 * kCandidates; ++i) {
    const Eigen::Vector2d place = Candidate(0.0, random);
    const double score = IsFree(place, place) ? PlaceScore(place, 0.0, others) + random.Uniform(0, 0.3) : -10.0;
    if (score > best) {
      best = score;
      first.from = first.to = place;
    }
  }
  std::vector<Leg> legs{first};
  while (legs.back().arrival_s < duration_s_) {
    const Leg& last = legs.back();
    const double speed = random.Uniform(0.8, 1.15);
    Leg chosen = last;  // stays where it is if there is nowhere to go
    chosen.from = last.to;
    chosen.departure_s = chosen.arrival_s = last.arrival_s + kTurn_s;
    chosen.walked_before_m = last.walked_before_m + (last.to - last.from).norm();
    best = -0.5;
    for (int i = 0; i < kCandidates; ++i) {
      Leg leg = chosen;
      leg.to = Candidate(last.arrival_s + 2.0, random);
      const double length = (leg.to - leg.from).norm();
      leg.arrival_s = leg.departure_s + length / speed;
      const double score = length > 0.8 && length < 4.0 && IsFree(leg.from, leg.to) ? LegScore(leg, others) : -1.0;
      if (score > best) {
        best = score;
        chosen = leg;
      }
    }
    legs.push_back(chosen);
  }
  return legs;
}

double Planner::SeatScore(const Seat& seat) const {
  double sum = 0;
  for (double t = 0; t <= duration_s_; t += kStep_s) {
    const Sight sight = SightOf(camera_, seat.position, t);
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
    stance.heading = Heading(last);
    stance.distance_m = last.walked_before_m + (last.to - last.from).norm();
    return stance;
  }
  const double duration_s = next->arrival_s - next->departure_s;
  const double share = duration_s > 0 ? std::clamp((time_s - next->departure_s) / duration_s, 0.0, 1.0) : 0.0;
  const double length = (next->to - next->from).norm();
  stance.position = next->from + share * (next->to - next->from);
  stance.distance_m = next->walked_before_m + share * length;
  stance.effort = std::clamp(std::min(share, 1.0 - share) * duration_s / 0.25, 0.0, 1.0);
  stance.heading = Heading(*next);
  if (next != legs.begin() && time_s < next->departure_s) {
    const double before = Heading(*std::prev(next));
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
  const Planner planner(room, camera, duration_s, WishOf(scenario));
  int sitting = scenario == SyntheticScenario::kSitting ? count : 0;
  if (scenario == SyntheticScenario::kCrowd) {
    sitting = count / 4 + (count > 2 ? 1 : 0);
  }
  std::vector<std::pair<double, Seat>> seats;
  for (const Seat& seat : room.seats) {
    const double score = planner.SeatScore(seat);
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
      movers.emplace_back(looks, planner.PlanWalk(movers, random));
    }
  }
  return movers;
}

}  // namespace rds::synthetic
