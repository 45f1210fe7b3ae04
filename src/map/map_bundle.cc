// SPDX-License-Identifier: Apache-2.0
#include "map/map_bundle.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "feature/keypoint_observation.h"

namespace rds {

std::vector<KeyframeId> KeyframesToAdjust(const Map& map, WorldId world, std::size_t most_edges) {
  std::vector<KeyframeId> all;
  std::size_t ends = 0;
  for (const KeyframeId id : map.keyframes()) {
    const Keyframe& keyframe = map.At(id);
    if (keyframe.world == world) {
      all.push_back(id);
      ends += keyframe.covisible.size();
    }
  }
  const double share = static_cast<double>(ends) / (2 * static_cast<double>(most_edges));
  const auto step = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(std::sqrt(share))));
  std::vector<KeyframeId> chosen;
  for (std::size_t i = 0; i < all.size(); i += step) {
    chosen.push_back(all[i]);
  }
  return chosen;
}

std::vector<PointId> PointsToAdjust(const Map& map, std::span<const KeyframeId> keyframes, bool weighted) {
  std::vector<PointId> points;
  for (const KeyframeId id : keyframes) {
    std::ranges::copy_if(map.At(id).points, std::back_inserter(points), &PointId::valid);
  }
  std::ranges::sort(points);
  const auto rest = std::ranges::unique(points);
  points.erase(rest.begin(), rest.end());
  if (weighted) {
    std::erase_if(points, [&](PointId id) { return map.probabilities().State(id) == PointState::kDynamic; });
  }
  return points;
}

std::optional<MapBundle> PlanBundle(const Map& map, std::span<const KeyframeId> adjusted,
                                    std::span<const KeyframeId> fixed, std::span<const PointId> points, bool weighted) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  MapBundle bundle;
  std::vector<std::uint32_t> pose_of(map.keyframes().empty() ? 0 : map.newest().index() + 1, kNone);
  const auto add = [&](KeyframeId id, bool is_fixed) {
    const Keyframe& keyframe = map.At(id);
    pose_of[id.index()] = static_cast<std::uint32_t>(bundle.keyframes.size());
    bundle.problem.camera = keyframe.data->camera();
    bundle.problem.poses.push_back({keyframe.camera_from_world, is_fixed || map.IsRoot(id)});
    bundle.keyframes.push_back({id, keyframe.pose_revision});
  };
  for (const KeyframeId id : adjusted) {
    add(id, false);
  }
  for (const KeyframeId id : fixed) {
    add(id, true);
  }
  if (!bundle.problem.poses.empty() && std::ranges::none_of(bundle.problem.poses, &BundleProblem::Pose::fixed)) {
    bundle.problem.poses.front().fixed = true;
  }
  for (const PointId id : points) {
    const MapPoint& point = map.At(id);
    const double weight = weighted ? 1.0 - map.probabilities().Get(id) : 1.0;
    const std::size_t before = bundle.problem.observations.size();
    for (const Observation& observation : point.observations) {
      if (const std::uint32_t pose = pose_of[observation.keyframe.index()]; pose != kNone) {
        const Keypoint& keypoint = map.At(observation.keyframe).data->keypoints()[observation.keypoint];
        bundle.problem.observations.push_back(
            {pose, static_cast<std::uint32_t>(bundle.points.size()), ObservationOf(keypoint, map.pyramid(), weight)});
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

void BendTo(Map& map, const MapBundle& bundle, const BundleResult& result) {
  const auto is_current = [&](const MapBundle::Point& point) {
    const MapPoint* const now = map.Find(point.id);
    const Keyframe* const host = map.Find(point.reference.keyframe);
    return now != nullptr && now->revision == point.revision && now->reference == point.reference.keyframe &&
           host != nullptr && host->pose_revision == point.reference.revision;
  };
  std::vector<std::size_t> current;
  for (std::size_t i = 0; i < bundle.points.size(); ++i) {
    if (is_current(bundle.points[i])) {
      current.push_back(i);
    }
  }
  std::vector<Map::WorldMove> moves;
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    if (map.Find(bundle.keyframes[i].keyframe) != nullptr) {
      moves.push_back(
          {bundle.keyframes[i].keyframe, result.poses[i].Inverse() * bundle.problem.poses[i].camera_from_world});
    }
  }
  map.Bend(moves);
  for (const std::size_t i : current) {
    map.Move(bundle.points[i].id, result.points[i]);
  }
  for (std::size_t i = 0; i < bundle.problem.observations.size(); ++i) {
    const BundleProblem::Observation& observation = bundle.problem.observations[i];
    const PointId point = bundle.points[observation.point].id;
    const KeyframeId keyframe = bundle.keyframes[observation.pose].keyframe;
    if (result.outlier[i] != 0 && map.Find(point) != nullptr && map.Find(keyframe) != nullptr) {
      map.Forget(point, keyframe);
    }
  }
}

}  // namespace rds
