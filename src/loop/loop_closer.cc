// SPDX-License-Identifier: Apache-2.0
#include "loop/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "base/log.h"
#include "map/map_bundle.h"
#include "place/point_fusion.h"

namespace rds {
namespace {

constexpr std::size_t kLoopCandidates = 3;
constexpr std::size_t kRelocalizationCandidates = 5;
constexpr int kSharedAround = 5;       // points that tie a keyframe to another
constexpr std::size_t kAround = 10;    // best covisible keyframes that are beside one
constexpr std::size_t kWitnesses = 2;  // that are asked
constexpr PlaceBounds kWitnessBounds{20, 0.85, 100, std::numeric_limits<double>::infinity()};
constexpr std::size_t kWeld = 15;  // covisible keyframes on which points are fused
constexpr int kErasedEvery = 100;  // keyframes
// A correction that the way travelled explains: several times what tracking drifts by, and what things that move may
// bend the map by (two people who sit, without a network: 0.6 m and 19 degrees on 5 m). Beyond it two places may look
// the same: of rooms that are all alike one was taken for the next, 7 m on, by 115 matches and two witnesses, and the
// pose graph bent to it.
constexpr double kDrift_m = 0.6;
constexpr double kDriftPerWay = 0.05;
constexpr double kTurn_rad = 20 * std::numbers::pi / 180;
constexpr double kTurnPerWay_rad = 0.25 * std::numbers::pi / 180;
// Below this there is nothing to bend.
constexpr double kNothing_m = 0.01;
constexpr double kNothing_rad = 0.2 * std::numbers::pi / 180;
// Beyond this the pose graph is not the last word.
constexpr double kFar_m = 0.03;
constexpr double kFar_rad = 0.5 * std::numbers::pi / 180;

// Of a full bundle adjustment, whose memory and time grow with them: 600 keyframes that all see the same.
constexpr std::size_t kMostEdges = 180'000;

// Two frames that were taken so long after one another agree.
constexpr double kBeside_s = 0.5;
constexpr double kBeside_m = 0.03;
constexpr double kSpeed_m_s = 1;
constexpr double kBeside_rad = 2 * std::numbers::pi / 180;
constexpr double kSpeed_rad_s = 90 * std::numbers::pi / 180;

bool AreBeside(const PlaceFound& before, const PlaceFound& now, double seconds) {
  const Rigid3 motion = now.camera_from_world * before.camera_from_world.Inverse();
  return before.world == now.world && before.map->epoch == now.map->epoch && std::abs(seconds) <= kBeside_s &&
         motion.translation.norm() <= kBeside_m + kSpeed_m_s * std::abs(seconds) &&
         AngleOf(motion.rotation) <= kBeside_rad + kSpeed_rad_s * std::abs(seconds);
}

// Length of the way between two keyframes of a world, meters, along those in between.
double WayBetween(const Map& map, KeyframeId a, KeyframeId b) {
  const auto [first, last] = std::minmax(a, b);
  const std::vector<KeyframeId>& ids = map.keyframes();
  double way_m = 0;
  const Keyframe* before = nullptr;
  for (auto id = std::ranges::lower_bound(ids, first); id != ids.end() && *id <= last; ++id) {
    const Keyframe& keyframe = map.At(*id);
    if (keyframe.world == map.At(a).world) {
      way_m += before != nullptr ? (keyframe.CameraCenter() - before->CameraCenter()).norm() : 0;
      before = &keyframe;
    }
  }
  return way_m;
}

}  // namespace

LoopCloser::LoopCloser(const LoopOptions& options, const ScalePyramid& pyramid, const PoseOptimizerOptions& pose,
                       bool semantics)
    : options_(options), pyramid_(pyramid), pose_(pose), semantics_(semantics) {}

void LoopCloser::Index(const MapAccess& map, KeyframeId keyframe) {
  const auto descriptors = map.Read([&](const Map& locked) {
    return locked.Find(keyframe) != nullptr ? std::optional(IndexedDescriptors(locked, keyframe)) : std::nullopt;
  });
  if (descriptors) {
    index_.Add(keyframe, *descriptors);
  }
  if (++indexed_ >= kErasedEvery) {
    DropErased(map);
  }
}

void LoopCloser::DropErased(const MapAccess& map) {
  indexed_ = 0;
  const std::vector<KeyframeId> erased = map.Read([&](const Map& locked) {
    std::vector<KeyframeId> gone = index_.Keyframes();
    std::erase_if(gone, [&](KeyframeId id) { return locked.Find(id) != nullptr; });
    return gone;
  });
  for (const KeyframeId id : erased) {
    index_.Remove(id);
  }
  std::erase_if(loops_, [&](const LoopEdge& loop) { return !index_.Has(loop.from) || !index_.Has(loop.to); });
}

std::optional<PlaceFound> LoopCloser::Relocalize(const MapAccess& map, const PlaceQuery& query, double timestamp_s) {
  const std::vector<PlaceScore> scores = index_.Query(query.Descriptors());
  const auto candidates = map.Read([&](const Map& locked) {
    return ProposePlaces(locked, scores, kRelocalizationCandidates, [](const Keyframe& /*any*/) { return true; });
  });
  std::optional<PlaceFound> best;
  for (const KeyframeId candidate : candidates) {
    const auto plan = map.Read([&](const Map& locked) { return PlanPlace(locked, candidate); });
    auto found = plan ? VerifyPlace(query, *plan, pyramid_, pose_) : std::nullopt;
    if (found && IsWithin(*found, kAgreeingBounds) && (!best || found->matches.size() > best->matches.size())) {
      best = std::move(found);
      if (std::ssize(best->matches) >= kClearMatches) {
        break;  // no other candidate is tried
      }
    }
  }
  const auto before = std::exchange(sighting_, std::nullopt);
  if (!best || IsWithin(*best, kRelocalizationBounds) ||
      (before && AreBeside(before->found, *best, timestamp_s - before->timestamp_s))) {
    return best;
  }
  sighting_ = Sighting{timestamp_s, *std::move(best)};
  return std::nullopt;
}

std::optional<LoopCloser::Subject> LoopCloser::Describe(const MapAccess& map, KeyframeId id) const {
  return map.Read([&](const Map& locked) -> std::optional<Subject> {
    const Keyframe* const keyframe = locked.Find(id);
    if (keyframe == nullptr) {
      return std::nullopt;
    }
    Subject subject{id, {keyframe->data, keyframe->labels}, keyframe->world, keyframe->camera_from_world, {}, {id}, {}};
    std::unordered_map<KeyframeId, int> shared;
    for (const PointId point : keyframe->points) {
      if (point.valid()) {
        for (const Observation& observation : locked.At(point).observations) {
          ++shared[observation.keyframe];
        }
      }
    }
    for (const auto& [tied, points] : shared) {
      if (points >= kSharedAround) {
        subject.around.insert(tied);
      }
    }
    if (keyframe->parent.valid()) {
      subject.around.insert(keyframe->parent);
    }
    subject.around.insert(keyframe->children.begin(), keyframe->children.end());
    subject.witnesses = locked.BestCovisible(id, kWitnesses);
    std::vector<KeyframeId> beside = locked.BestCovisible(id, kAround);
    beside.push_back(id);
    subject.known = locked.PointsOf(beside);
    return subject;
  });
}

std::optional<PlaceFound> LoopCloser::FindAgain(const MapAccess& map, const Subject& subject,
                                                std::span<const PlaceScore> scores, bool in_own_world) const {
  const auto candidates = map.Read([&](const Map& locked) {
    return ProposePlaces(locked, scores, kLoopCandidates, [&](const Keyframe& keyframe) {
      return (keyframe.world == subject.world) == in_own_world && !subject.around.contains(keyframe.id);
    });
  });
  for (const KeyframeId candidate : candidates) {
    const auto plan = map.Read([&](const Map& locked) { return PlanPlace(locked, candidate, subject.known); });
    auto found = plan ? VerifyPlace(subject.query, *plan, pyramid_, pose_) : std::nullopt;
    if (found && IsWithin(*found, kLoopBounds) && (!in_own_world || IsExplained(map, subject, *found)) &&
        IsBeyondChance(subject.query, *found, *plan, pyramid_) && IsWitnessed(map, subject, *plan, *found)) {
      return found;
    }
  }
  return std::nullopt;
}

bool LoopCloser::IsExplained(const MapAccess& map, const Subject& subject, const PlaceFound& found) {
  const Rigid3 shift = found.camera_from_world * subject.camera_from_world.Inverse();
  const double way_m = map.Read([&](const Map& locked) {
    const bool both = locked.Find(found.keyframe) != nullptr && locked.Find(subject.id) != nullptr;
    return both ? WayBetween(locked, found.keyframe, subject.id) : 0.0;
  });
  return shift.translation.norm() <= kDrift_m + kDriftPerWay * way_m &&
         AngleOf(shift.rotation) <= kTurn_rad + kTurnPerWay_rad * way_m;
}

bool LoopCloser::IsWitnessed(const MapAccess& map, const Subject& subject, const PlaceCandidate& surroundings,
                             const PlaceFound& found) const {
  struct Witness {
    PlaceQuery query;
    Rigid3 camera_from_own_world;
  };
  // Where the keyframe's world lies in that of the place.
  const Rigid3 place_world_from_own = found.camera_from_world.Inverse() * subject.camera_from_world;
  for (const KeyframeId id : subject.witnesses) {
    const auto witness = map.Read([&](const Map& locked) -> std::optional<Witness> {
      const Keyframe* const keyframe = locked.Find(id);
      return keyframe != nullptr
                 ? std::optional(Witness{{keyframe->data, keyframe->labels}, keyframe->camera_from_world})
                 : std::nullopt;
    });
    if (!witness) {
      continue;
    }
    const auto seen = VerifyPose(witness->query, witness->camera_from_own_world * place_world_from_own.Inverse(),
                                 surroundings, pyramid_, pose_);
    if (seen && IsWithin(*seen, kWitnessBounds)) {
      return true;
    }
  }
  return false;
}

std::optional<Closure> LoopCloser::Close(MapAccess& map, KeyframeId keyframe) {
  const auto subject = Describe(map, keyframe);
  if (!subject) {
    return std::nullopt;
  }
  const std::vector<PlaceScore> scores = index_.Query(subject->query.Descriptors());
  if (const auto found = FindAgain(map, *subject, scores, false)) {
    return MergeWorlds(map, keyframe, *found);
  }
  if (const auto found = FindAgain(map, *subject, scores, true)) {
    return CloseLoop(map, *subject, *found);
  }
  return std::nullopt;
}

std::optional<Closure> LoopCloser::CloseLoop(MapAccess& map, const Subject& subject, const PlaceFound& found) {
  const KeyframeId keyframe = subject.id;
  const LoopEdge loop{found.keyframe, keyframe, found.camera_from_keyframe, static_cast<int>(found.matches.size())};
  const Rigid3 correction = found.camera_from_world.Inverse() * subject.camera_from_world;
  std::vector<LoopEdge> loops = loops_;
  loops.push_back(loop);
  const Rigid3 shift = found.camera_from_world * subject.camera_from_world.Inverse();
  const double shift_m = shift.translation.norm();
  const double shift_rad = AngleOf(shift.rotation);
  const bool moves = shift_m > kNothing_m || shift_rad > kNothing_rad;
  if (moves) {
    const EssentialGraph graph =
        map.Read([&](const Map& locked) { return PlanEssentialGraph(locked, subject.world, loops); });
    const auto bend = CloseGraph(graph);
    if (!bend) {
      log::info("a loop from keyframe {} to {} contradicts the map and is left out", keyframe.value,
                found.keyframe.value);
      return std::nullopt;
    }
    const bool bent = map.Write([&](Map& locked) {
      const bool is_current = locked.epoch() == graph.epoch;
      if (is_current) {
        locked.Bend(*bend);
      }
      return is_current;
    });
    if (!bent) {
      return std::nullopt;  // it is seen again
    }
  }
  loops_ = std::move(loops);
  Weld(map, keyframe, found);
  Closure closure;
  closure.keyframe = keyframe;
  closure.place = found.keyframe;
  closure.world = subject.world;
  closure.into_from_from = correction;
  closure.matches = loop.matches;
  closure.moved = moves;
  closure.moved_far = shift_m > kFar_m || shift_rad > kFar_rad;
  return closure;
}

std::optional<Closure> LoopCloser::MergeWorlds(MapAccess& map, KeyframeId keyframe, const PlaceFound& found) {
  const auto closure = map.Write([&](Map& locked) -> std::optional<Closure> {
    const Keyframe* const own = locked.Find(keyframe);
    const Keyframe* const place = locked.Find(found.keyframe);
    if (own == nullptr || place == nullptr || own->world == place->world) {
      return std::nullopt;
    }
    // By relative poses, as either may have been corrected since.
    const Rigid3 place_world_from_own =
        place->camera_from_world.Inverse() * found.camera_from_keyframe.Inverse() * own->camera_from_world;
    const std::size_t own_size = locked.KeyframesIn(own->world);
    const std::size_t place_size = locked.KeyframesIn(place->world);
    const bool own_stays = options_.keep == KeptWorld::kCurrent || own_size > place_size ||
                           (own_size == place_size && own->world < place->world);
    Closure result;
    result.keyframe = keyframe;
    result.place = found.keyframe;
    result.matches = static_cast<int>(found.matches.size());
    result.world = own_stays ? own->world : place->world;
    result.merged = own_stays ? place->world : own->world;
    result.into_from_from = own_stays ? place_world_from_own.Inverse() : place_world_from_own;
    if (own_stays) {
      locked.Merge(found.keyframe, keyframe, result.into_from_from);
    } else {
      locked.Merge(keyframe, found.keyframe, result.into_from_from);
    }
    return result;
  });
  if (closure) {
    loops_.push_back({found.keyframe, keyframe, found.camera_from_keyframe, static_cast<int>(found.matches.size())});
    Weld(map, keyframe, found);
  }
  return closure;
}

// Points that both sides see become one.
void LoopCloser::Weld(MapAccess& map, KeyframeId keyframe, const PlaceFound& found) {
  std::vector<KeyframeId> weld = map.Write([&](Map& locked) -> std::vector<KeyframeId> {
    const Keyframe* const seen_again = locked.Find(keyframe);
    if (seen_again == nullptr) {
      return {};
    }
    Correction correction;
    for (const auto& [keypoint, point] : found.matches) {
      correction.matches.push_back({point, {keyframe, seen_again->pose_revision}, keypoint});
    }
    locked.Apply(correction);
    locked.UpdateCovisibility(keyframe);
    std::vector<KeyframeId> beside = locked.BestCovisible(keyframe, kWeld);
    beside.insert(beside.begin(), keyframe);
    return beside;
  });
  const std::vector<PointId> there = map.Read([&](const Map& locked) {
    std::vector<KeyframeId> around = locked.Find(found.keyframe) != nullptr
                                         ? locked.BestCovisible(found.keyframe, kWeld)
                                         : std::vector<KeyframeId>{};
    around.push_back(found.keyframe);
    std::erase_if(around, [&](KeyframeId id) { return locked.Find(id) == nullptr; });
    return PointsToAdjust(locked, around, semantics_);
  });
  for (const KeyframeId target : weld) {
    map.Commit(
        [&](const Map& locked) {
          return locked.Find(target) != nullptr ? PlanFusion(locked, target, there) : std::nullopt;
        },
        SolveFusion);
  }
  map.Write([&](Map& locked) {
    for (const KeyframeId target : weld) {
      if (locked.Find(target) != nullptr) {
        locked.UpdateCovisibility(target);
      }
    }
  });
}

bool LoopCloser::Adjust(MapAccess& map, WorldId world, const std::function<bool()>& stop) const {
  std::uint32_t epoch = 0;
  const auto bundle = map.Read([&](const Map& locked) {
    epoch = locked.epoch();
    const std::vector<KeyframeId> adjusted = KeyframesToAdjust(locked, locked.Resolve(world), kMostEdges);
    return PlanBundle(locked, adjusted, {}, PointsToAdjust(locked, adjusted, semantics_), semantics_);
  });
  if (!bundle) {
    return false;
  }
  bool stopped = false;
  const BundleResult result = AdjustBundle(bundle->problem, options_.solver, [&] {
    stopped = stopped || (stop && stop());
    return stopped;
  });
  if (stopped || !result.usable) {
    return false;
  }
  return map.Write([&](Map& locked) {
    if (locked.epoch() != epoch) {
      return false;
    }
    BendTo(locked, *bundle, result);
    return true;
  });
}

}  // namespace rds
