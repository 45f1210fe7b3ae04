// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_mapper.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "semantic/evidence.h"

namespace rds {

LocalMapper::LocalMapper(const MappingOptions& options, const MovingProbabilityOptions& probability_options,
                         MovingProbabilities& probabilities)
    : options_(options), probability_options_(probability_options), probabilities_(probabilities) {}

KeyframeId LocalMapper::Insert(Map& map, const KeyframeCandidate& candidate) {
  const Rigid3 pose = candidate.reference.valid()
                          ? candidate.camera_from_reference * map.CameraFromWorld(candidate.reference)
                          : candidate.camera_from_reference;
  Keyframe& keyframe = map.AddKeyframe(candidate.frame, candidate.timestamp_s, pose, candidate.data);
  for (const PointUse& use : candidate.uses) {
    if (MapPoint* point = map.Find(map.Resolve(use.point))) {
      point->visible += use.visible;
      point->found += use.found;
    }
  }
  AddTrackedPoints(map, keyframe, candidate);
  AddDepthPoints(map, keyframe, candidate);
  map.UpdateCovisibility(keyframe.id);
  return keyframe.id;
}

void LocalMapper::AddTrackedPoints(Map& map, Keyframe& keyframe, const KeyframeCandidate& candidate) {
  for (std::size_t i = 0; i < candidate.points.size(); ++i) {
    const PointId id = candidate.points[i].valid() ? map.Resolve(candidate.points[i]) : PointId{};
    if (id.valid() &&
        AddObservation(map, id, keyframe.id, static_cast<std::uint32_t>(i), probabilities_, probability_options_)) {
      map.UpdateAppearance(id);
    }
  }
}

void LocalMapper::AddDepthPoints(Map& map, Keyframe& keyframe, const KeyframeCandidate& candidate) {
  const FrameData& data = *keyframe.data;
  std::vector<bool> blocked(data.size(), false);
  for (const std::uint32_t keypoint : candidate.blocked) {
    blocked[keypoint] = true;
  }
  std::vector<std::pair<float, std::uint32_t>> by_depth;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (data.keypoints()[i].HasDepth() && !blocked[i]) {
      by_depth.emplace_back(data.keypoints()[i].depth_m, static_cast<std::uint32_t>(i));
    }
  }
  std::ranges::sort(by_depth);
  const double close_m = options_.close_baselines * data.camera().baseline_m;
  const Rigid3 world_from_camera = keyframe.camera_from_world.Inverse();
  for (std::size_t rank = 0; rank < by_depth.size(); ++rank) {
    const auto [depth_m, index] = by_depth[rank];
    if (static_cast<double>(depth_m) > close_m && static_cast<int>(rank) >= options_.min_depth_points) {
      break;
    }
    if (!keyframe.points[index].valid()) {
      const Keypoint& keypoint = data.keypoints()[index];
      const Eigen::Vector3d in_camera = data.camera().Unproject(
          {static_cast<double>(keypoint.x), static_cast<double>(keypoint.y)}, static_cast<double>(depth_m));
      const PointId point =
          AddPoint(map, world_from_camera * in_camera, keyframe.id, index, probabilities_, probability_options_).id;
      if (!candidate.probabilities.empty()) {
        probabilities_.Set(point, candidate.probabilities[index]);
      }
      recent_points_.push_back(point);
    }
  }
}

void LocalMapper::Refine(Map& map, KeyframeId keyframe) {
  CullRecentPoints(map, keyframe);
  Triangulate(map, keyframe);
  Fuse(map, keyframe);
  map.UpdateCovisibility(keyframe);
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

std::vector<KeyframeId> LocalMapper::CullKeyframes(Map& map, KeyframeId newest) {
  std::vector<KeyframeId> removed;
  for (const KeyframeId id : map.BestCovisible(newest, static_cast<std::size_t>(options_.cull_keyframes))) {
    const Keyframe& keyframe = map.At(id);
    if (keyframe.parent.valid() && id != newest && IsRedundant(map, keyframe)) {
      map.EraseKeyframe(id);
      removed.push_back(id);
    }
  }
  return removed;
}

bool LocalMapper::IsRedundant(const Map& map, const Keyframe& keyframe) const {
  const double close_m = options_.close_baselines * keyframe.data->camera().baseline_m;
  int examined = 0;
  int redundant = 0;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    const Keypoint& keypoint = keyframe.data->keypoints()[i];
    if (!keyframe.points[i].valid() || !keypoint.HasDepth() || static_cast<double>(keypoint.depth_m) > close_m) {
      continue;
    }
    ++examined;
    int others = 0;
    for (const Observation& observation : map.At(keyframe.points[i]).observations) {
      others +=
          observation.keyframe != keyframe.id &&
                  map.At(observation.keyframe).data->keypoints()[observation.keypoint].octave <= keypoint.octave + 1
              ? 1
              : 0;
    }
    redundant += others >= options_.redundant_observations ? 1 : 0;
  }
  return redundant > options_.redundant_ratio * examined;
}

}  // namespace rds
