// SPDX-License-Identifier: Apache-2.0
#include "semantic/semantic_optimizer.h"

#include <numbers>

#include "feature/keypoint_observation.h"

namespace rds {
namespace {

bool IsMadeBy(const MapPoint& point, KeyframeId keyframe) { return point.observations.front().keyframe == keyframe; }

}  // namespace

std::optional<SemanticPoseProblem> CopyStaticMatches(const Map& map, KeyframeId id,
                                                     const MovingProbabilities& probabilities,
                                                     const MovingProbabilityOptions& probability_options,
                                                     const SemanticOptimizerOptions& options) {
  const Keyframe* keyframe = map.Find(id);
  if (keyframe == nullptr || id == map.keyframes().front()) {  // the root defines the world
    return std::nullopt;
  }
  SemanticPoseProblem problem{id, keyframe->pose_revision, keyframe->data->camera(), keyframe->camera_from_world, {}};
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    if (!keyframe->points[i].valid()) {
      continue;
    }
    const MapPoint& point = map.At(keyframe->points[i]);
    const double p = probabilities.Get(point.id);
    // A point that this keyframe made lies where its pose put it and says nothing about that pose.
    if (IsMadeBy(point, id) || StateOf(p, probability_options) != PointState::kStatic) {
      continue;
    }
    const Keypoint& keypoint = keyframe->data->keypoints()[i];
    problem.observations.push_back({point.position, ObservationOf(keypoint, map.pyramid(), 1.0 - p)});
  }
  if (std::ssize(problem.observations) < options.min_static) {
    return std::nullopt;
  }
  return problem;
}

bool ApplySemanticPose(Map& map, const SemanticPoseProblem& problem, const PoseResult& result,
                       const SemanticOptimizerOptions& options) {
  Keyframe* keyframe = map.Find(problem.keyframe);
  if (keyframe == nullptr || keyframe->pose_revision != problem.revision || !result.converged ||
      result.inliers < options.min_static) {
    return false;
  }
  const Rigid3 new_world_from_old_world = result.camera_from_world.Inverse() * problem.camera_from_world;
  const double turn_deg = AngleOf(new_world_from_old_world.rotation) * 180.0 / std::numbers::pi;
  const double shift_m = (result.camera_from_world.Inverse().translation - keyframe->CameraCenter()).norm();
  if (shift_m < options.min_shift_m && turn_deg < options.min_rotation_deg) {
    return false;
  }
  map.SetPose(keyframe->id, result.camera_from_world);
  for (const PointId id : keyframe->points) {
    if (id.valid() && IsMadeBy(map.At(id), problem.keyframe)) {
      MapPoint& point = map.At(id);
      point.position = new_world_from_old_world * point.position;
      map.UpdateNormal(id);
    }
  }
  return true;
}

}  // namespace rds
