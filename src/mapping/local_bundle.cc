// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_bundle.h"

#include <algorithm>
#include <map>

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

std::optional<MapBundle> PlanLocalBundle(const Map& map, KeyframeId center, bool semantics,
                                         const LocalBundleOptions& options) {
  const bool weighted = semantics && options.weighted;
  const std::vector<KeyframeId> adjusted = SelectFree(map, center, semantics, options);
  const std::vector<PointId> points = PointsToAdjust(map, adjusted, weighted);
  return PlanBundle(map, adjusted, SelectFixed(map, adjusted, points, options), points, weighted);
}

std::optional<Correction> SolveLocalBundle(const MapBundle& bundle, const BundleOptions& options,
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
    const MapBundle::Point& point = bundle.points[i];
    correction.points.push_back({point.id, point.revision, point.reference, result.points[i]});
  }
  return correction;
}

}  // namespace rds
