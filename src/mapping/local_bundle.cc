// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_bundle.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

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

std::optional<LocalBundle> PlanLocalBundle(const Map& map, KeyframeId center, bool semantics,
                                           const LocalBundleOptions& options) {
  LocalBundle bundle;
  const bool weighted = semantics && options.weighted;
  const MovingProbabilities& probabilities = map.probabilities();
  const std::vector<KeyframeId> free_keyframes = SelectFree(map, center, semantics, options);
  std::vector<PointId> points;
  for (const KeyframeId id : free_keyframes) {
    std::ranges::copy_if(map.At(id).points, std::back_inserter(points), &PointId::valid);
  }
  std::ranges::sort(points);
  const auto rest = std::ranges::unique(points);
  points.erase(rest.begin(), rest.end());
  if (weighted) {  // a point known to move constrains nothing
    std::erase_if(points, [&](PointId id) { return probabilities.State(id) == PointState::kDynamic; });
  }
  std::vector<KeyframeId> keyframes = free_keyframes;
  const std::vector<KeyframeId> fixed = SelectFixed(map, free_keyframes, points, options);
  keyframes.insert(keyframes.end(), fixed.begin(), fixed.end());

  std::map<KeyframeId, std::uint32_t> pose_of;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = map.At(id);
    const auto index = static_cast<std::uint32_t>(bundle.keyframes.size());
    bundle.problem.camera = keyframe.data->camera();
    bundle.problem.poses.push_back({keyframe.camera_from_world, map.IsRoot(id) || index >= free_keyframes.size()});
    bundle.keyframes.push_back({id, keyframe.pose_revision});
    pose_of[id] = index;
  }
  if (std::ranges::none_of(bundle.problem.poses, &BundleProblem::Pose::fixed)) {
    bundle.problem.poses.front().fixed = true;  // the oldest of the window
  }
  for (const PointId id : points) {
    const MapPoint& point = map.At(id);
    const double weight = weighted ? 1.0 - probabilities.Get(id) : 1.0;
    const std::size_t before = bundle.problem.observations.size();
    for (const Observation& observation : point.observations) {
      const auto pose = pose_of.find(observation.keyframe);
      if (pose != pose_of.end()) {
        const Keypoint& keypoint = map.At(observation.keyframe).data->keypoints()[observation.keypoint];
        bundle.problem.observations.push_back({pose->second, static_cast<std::uint32_t>(bundle.points.size()),
                                               ObservationOf(keypoint, map.pyramid(), weight)});
      }
    }
    const std::size_t added = bundle.problem.observations.size() - before;
    if (added == 0 || (added == 1 && !bundle.problem.observations.back().keypoint.HasDepth())) {
      bundle.problem.observations.resize(before);  // its depth would be free
    } else {
      bundle.points.push_back({id, point.revision, {point.reference, map.At(point.reference).pose_revision}});
      bundle.problem.points.push_back(point.position);
    }
  }
  const bool worthwhile = map.keyframes().size() >= 2 && !bundle.problem.points.empty() &&
                          std::ranges::any_of(bundle.problem.poses, [](const auto& pose) { return !pose.fixed; });
  return worthwhile ? std::optional(std::move(bundle)) : std::nullopt;
}

std::optional<Correction> SolveLocalBundle(const LocalBundle& bundle, const BundleOptions& options,
                                           const std::function<bool()>& should_stop) {
  const BundleResult result = AdjustBundle(bundle.problem, options, should_stop);
  if (!result.usable) {
    return std::nullopt;
  }
  Correction correction;
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    if (!bundle.problem.poses[i].fixed) {
      correction.poses.push_back({bundle.keyframes[i], result.poses[i]});
    }
  }
  for (std::size_t i = 0; i < bundle.problem.observations.size(); ++i) {
    if (result.outlier[i] != 0) {
      const BundleProblem::Observation& observation = bundle.problem.observations[i];
      correction.removals.push_back({bundle.points[observation.point].id, bundle.keyframes[observation.pose].keyframe});
    }
  }
  for (std::size_t i = 0; i < bundle.points.size(); ++i) {
    const LocalBundle::Point& point = bundle.points[i];
    correction.points.push_back({point.id, point.revision, point.reference, result.points[i]});
  }
  return correction;
}

}  // namespace rds
