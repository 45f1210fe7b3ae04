// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_mapper.h"

#include <algorithm>
#include <utility>

#include "mapping/local_bundle.h"
#include "mapping/point_creation.h"
#include "place/point_fusion.h"

namespace rds {
namespace {

constexpr std::size_t kSecondNeighbors = 5;  // that each neighbor adds to the search for duplicates: bounds it

// Keyframes that may show the same points: neighbors and their neighbors.
std::vector<KeyframeId> FusionTargets(const Map& map, KeyframeId id, std::size_t neighbors) {
  std::vector<KeyframeId> targets = map.BestCovisible(id, neighbors);
  const std::size_t direct = targets.size();
  for (std::size_t i = 0; i < direct; ++i) {
    for (const KeyframeId second : map.BestCovisible(targets[i], kSecondNeighbors)) {
      if (second != id && std::ranges::find(targets, second) == targets.end()) {
        targets.push_back(second);
      }
    }
  }
  return targets;
}

}  // namespace

KeyframeId LocalMapper::Insert(Map& map, const KeyframeCandidate& candidate) {
  const bool starts_world = !candidate.reference.valid();
  const Rigid3 pose = starts_world ? candidate.camera_from_reference
                                   : candidate.camera_from_reference * map.CameraFromWorld(candidate.reference);
  const WorldId world = starts_world ? map.AddWorld() : map.WorldOf(candidate.reference);
  const KeyframeId id = map.AddKeyframe(candidate.frame, candidate.timestamp_s, pose, candidate.data, world);
  for (const PointUse& use : candidate.uses) {
    if (const PointId point = map.Resolve(use.point); point.valid()) {
      map.CountUse(point, use.visible, use.found);
    }
  }
  ObserveTrackedPoints(map, id, candidate);
  AddDepthPoints(map, map.At(id), candidate);
  map.UpdateCovisibility(id);
  return id;
}

void LocalMapper::ObserveTrackedPoints(Map& map, KeyframeId keyframe, const KeyframeCandidate& candidate) {
  for (std::size_t i = 0; i < candidate.points.size(); ++i) {
    const PointId id = candidate.points[i].valid() ? map.Resolve(candidate.points[i]) : PointId{};
    if (id.valid() && map.Observe(id, keyframe, static_cast<std::uint32_t>(i))) {
      map.UpdateAppearance(id);
    }
  }
}

void LocalMapper::AddDepthPoints(Map& map, const Keyframe& keyframe, const KeyframeCandidate& candidate) {
  const FrameData& data = *keyframe.data;
  std::vector<bool> blocked(data.size(), false);
  for (const std::uint32_t keypoint : candidate.blocked) {
    blocked[keypoint] = true;
  }
  const Rigid3 world_from_camera = keyframe.camera_from_world.Inverse();
  for (std::uint32_t index = 0; index < data.size(); ++index) {
    if (data.keypoints()[index].HasDepth() && !blocked[index] && !keyframe.points[index].valid()) {
      const Eigen::Vector3d in_camera = data.keypoints()[index].PointIn(data.camera());
      const PointId point = map.AddPoint(world_from_camera * in_camera, keyframe.id, index);
      if (!candidate.probabilities.empty()) {
        map.SetMovingProbability(point, candidate.probabilities[index]);
      }
      recent_points_.push_back(point);
    }
  }
}

void LocalMapper::Refine(MapAccess& map, KeyframeId keyframe) {
  map.Write([&](Map& locked) { CullRecentPoints(locked, keyframe); });
  CreatePoints(map, keyframe);
  FusePoints(map, keyframe);
  map.Write([&](Map& locked) { locked.UpdateCovisibility(keyframe); });
}

void LocalMapper::CullRecentPoints(Map& map, KeyframeId newest) {
  std::erase_if(recent_points_, [&](PointId id) {
    const MapPoint* point = map.Find(id);
    if (point == nullptr) {
      return true;
    }
    const int age = static_cast<int>(newest.value - point->created_at.value);
    const bool rarely_found = point->found < options_.min_found_ratio * point->visible;
    const bool rarely_seen = age >= 2 && std::ssize(point->observations) < options_.min_observations;
    if (rarely_found || rarely_seen) {
      map.ErasePoint(id);
      return true;
    }
    return age >= options_.probation_keyframes;
  });
}

void LocalMapper::CreatePoints(MapAccess& map, KeyframeId keyframe) {
  const auto neighbors = map.Read([&](const Map& locked) {
    return locked.BestCovisible(keyframe, static_cast<std::size_t>(options_.triangulate_neighbors));
  });
  for (const KeyframeId neighbor : neighbors) {
    const Applied applied =
        map.Commit([&](const Map& locked) { return PlanCreation(locked, keyframe, neighbor); },
                   [&](const auto& problem) { return SolveCreation(problem, options_.triangulate_ratio); });
    recent_points_.insert(recent_points_.end(), applied.new_points.begin(), applied.new_points.end());
  }
}

void LocalMapper::FusePoints(MapAccess& map, KeyframeId keyframe) {
  const std::vector<KeyframeId> targets = map.Read([&](const Map& locked) {
    return FusionTargets(locked, keyframe, static_cast<std::size_t>(options_.fuse_neighbors));
  });
  for (const KeyframeId target : targets) {
    map.Commit([&](const Map& locked) { return PlanFusion(locked, target, locked.At(keyframe).points); }, SolveFusion);
  }
  map.Commit([&](const Map& locked) { return PlanFusion(locked, keyframe, locked.PointsOf(targets)); }, SolveFusion);
  map.Write([&](Map& locked) {
    for (const PointId point : locked.At(keyframe).points) {
      if (point.valid()) {
        locked.UpdateAppearance(point);
      }
    }
  });
}

bool LocalMapper::Adjust(MapAccess& map, KeyframeId keyframe, bool semantics,
                         const std::function<bool()>& should_stop) {
  bool planned = false;
  map.Commit(
      [&](const Map& locked) {
        auto bundle = PlanLocalBundle(locked, keyframe, semantics, options_.bundle);
        planned = bundle.has_value();
        return bundle;
      },
      [&](const MapBundle& bundle) { return SolveLocalBundle(bundle, options_.bundle.solver, should_stop); });
  return planned;
}

void LocalMapper::CullKeyframes(MapAccess& map, KeyframeId newest) {
  const auto candidates = map.Read([&](const Map& locked) {
    return locked.BestCovisible(newest, static_cast<std::size_t>(options_.cull_keyframes));
  });
  for (const KeyframeId id : candidates) {
    const bool redundant = map.Read([&](const Map& locked) {
      const Keyframe& keyframe = locked.At(id);
      return keyframe.parent.valid() && id != newest && IsRedundant(locked, keyframe);
    });
    if (redundant) {
      map.Write([&](Map& locked) { locked.EraseKeyframe(id); });
    }
  }
}

bool LocalMapper::IsRedundant(const Map& map, const Keyframe& keyframe) const {
  int examined = 0;
  int redundant = 0;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    const Keypoint& keypoint = keyframe.data->keypoints()[i];
    if (!keyframe.points[i].valid() || !keypoint.HasDepth()) {
      continue;
    }
    ++examined;
    int others = 0;
    for (const Observation& observation : map.At(keyframe.points[i]).observations) {
      const Keypoint& other = map.At(observation.keyframe).data->keypoints()[observation.keypoint];
      others += observation.keyframe != keyframe.id && other.octave <= keypoint.octave + 1 ? 1 : 0;
    }
    redundant += others >= options_.redundant_observations ? 1 : 0;
  }
  return redundant > options_.redundant_ratio * examined;
}

}  // namespace rds
