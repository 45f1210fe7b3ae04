// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_bundle.h"

#include <algorithm>
#include <map>

#include "feature/keypoint_observation.h"

namespace rds {
namespace {

// Keyframes to optimize: the center and its best covisible ones; only labeled ones where the options ask for it and
// enough are there.
std::vector<KeyframeId> SelectFree(const Map& map, KeyframeId center, bool semantics,
                                   const LocalBundleOptions& options) {
  std::vector<KeyframeId> all = {center};
  std::vector<KeyframeId> labeled;
  for (const Covisible& edge : map.At(center).covisible) {
    all.push_back(edge.keyframe);
  }
  for (const KeyframeId id : all) {
    if (map.At(id).IsLabeled()) {
      labeled.push_back(id);
    }
  }
  const bool filter = semantics && options.labeled_only && std::ssize(labeled) >= options.enough_labeled;
  std::vector<KeyframeId>& chosen = filter ? labeled : all;
  chosen.resize(std::min(chosen.size(), static_cast<std::size_t>(options.keyframes)));
  std::ranges::sort(chosen);
  return chosen;
}

// Other keyframes that see the points, those with most of them first.
std::vector<KeyframeId> SelectFixed(const Map& map, const std::vector<KeyframeId>& free_keyframes,
                                    const std::vector<PointId>& points, const LocalBundleOptions& options) {
  std::map<KeyframeId, int> shared;
  for (const PointId point : points) {
    for (const Observation& observation : map.At(point).observations) {
      ++shared[observation.keyframe];
    }
  }
  for (const KeyframeId id : free_keyframes) {
    shared.erase(id);
  }
  std::vector<Covisible> others;
  for (const auto& [id, count] : shared) {
    others.push_back({id, count});
  }
  std::ranges::stable_sort(others, std::greater<>(), &Covisible::shared_points);
  others.resize(std::min(others.size(), static_cast<std::size_t>(options.fixed_keyframes)));
  std::vector<KeyframeId> chosen;
  for (const Covisible& other : others) {
    chosen.push_back(other.keyframe);
  }
  return chosen;
}

}  // namespace

LocalBundle CopyLocalBundle(const Map& map, KeyframeId center, bool semantics, const MovingProbabilities& probabilities,
                            const MovingProbabilityOptions& probability_options, const LocalBundleOptions& options) {
  LocalBundle bundle;
  const bool weighted = semantics && options.weighted;
  const std::vector<KeyframeId> free_keyframes = SelectFree(map, center, semantics, options);
  for (const KeyframeId id : free_keyframes) {
    for (const PointId point : map.At(id).points) {
      if (point.valid()) {
        bundle.points.push_back(point);
      }
    }
  }
  std::ranges::sort(bundle.points);
  const auto rest = std::ranges::unique(bundle.points);
  bundle.points.erase(rest.begin(), rest.end());
  if (weighted) {  // a point known to move constrains nothing
    std::erase_if(bundle.points, [&](PointId id) {
      return StateOf(probabilities.Get(id), probability_options) == PointState::kDynamic;
    });
  }
  bundle.keyframes = free_keyframes;
  const std::vector<KeyframeId> fixed = SelectFixed(map, free_keyframes, bundle.points, options);
  bundle.keyframes.insert(bundle.keyframes.end(), fixed.begin(), fixed.end());

  std::map<KeyframeId, std::uint32_t> pose_of;
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    const Keyframe& keyframe = map.At(bundle.keyframes[i]);
    bundle.problem.camera = keyframe.data->camera();
    const bool is_root = keyframe.id == map.keyframes().front();
    bundle.problem.poses.push_back({keyframe.camera_from_world, is_root || i >= free_keyframes.size()});
    bundle.revisions.push_back(keyframe.pose_revision);
    pose_of[keyframe.id] = static_cast<std::uint32_t>(i);
  }
  if (std::ranges::none_of(bundle.problem.poses, &BundleProblem::Pose::fixed)) {
    bundle.problem.poses.front().fixed = true;  // the oldest of the window
  }
  std::vector<PointId> kept;
  for (const PointId id : bundle.points) {
    const MapPoint& point = map.At(id);
    const double weight = weighted ? 1.0 - probabilities.Get(id) : 1.0;
    const std::size_t before = bundle.problem.observations.size();
    for (const Observation& observation : point.observations) {
      const auto pose = pose_of.find(observation.keyframe);
      if (pose != pose_of.end()) {
        const Keypoint& keypoint = map.At(observation.keyframe).data->keypoints()[observation.keypoint];
        bundle.problem.observations.push_back(
            {pose->second, static_cast<std::uint32_t>(kept.size()), ObservationOf(keypoint, map.pyramid(), weight)});
      }
    }
    const std::size_t added = bundle.problem.observations.size() - before;
    if (added == 0 || (added == 1 && !bundle.problem.observations.back().keypoint.HasDepth())) {
      bundle.problem.observations.resize(before);  // its depth would be free
    } else {
      kept.push_back(id);
      bundle.problem.points.push_back(point.position);
    }
  }
  bundle.points = std::move(kept);
  bundle.worthwhile = map.keyframes().size() >= 2 && !bundle.problem.points.empty() &&
                      std::ranges::any_of(bundle.problem.poses, [](const auto& pose) { return !pose.fixed; });
  return bundle;
}

void ApplyLocalBundle(Map& map, const LocalBundle& bundle, const BundleResult& result) {
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    const Keyframe* keyframe = map.Find(bundle.keyframes[i]);
    if (keyframe != nullptr && !bundle.problem.poses[i].fixed && keyframe->pose_revision == bundle.revisions[i]) {
      map.SetPose(keyframe->id, result.poses[i]);
    }
  }
  for (std::size_t i = 0; i < bundle.problem.observations.size(); ++i) {
    const BundleProblem::Observation& observation = bundle.problem.observations[i];
    const PointId point = bundle.points[observation.point];
    if (result.outlier[i] != 0 && map.Find(point) != nullptr &&
        map.Find(bundle.keyframes[observation.pose]) != nullptr) {
      map.RemoveObservation(point, bundle.keyframes[observation.pose]);
    }
  }
  for (std::size_t i = 0; i < bundle.points.size(); ++i) {
    if (MapPoint* point = map.Find(bundle.points[i])) {
      point->position = result.points[i];
      map.UpdateNormal(point->id);
    }
  }
}

}  // namespace rds
