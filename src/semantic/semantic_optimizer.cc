// SPDX-License-Identifier: Apache-2.0
#include "semantic/semantic_optimizer.h"

#include <numbers>

#include "feature/keypoint_observation.h"

namespace rds {

std::optional<SemanticPoseProblem> PlanSemanticPose(const Map& map, KeyframeId id,
                                                    const SemanticOptimizerOptions& options) {
  const Keyframe* keyframe = map.Find(id);
  if (keyframe == nullptr || map.IsRoot(id)) {  // the root defines the world
    return std::nullopt;
  }
  SemanticPoseProblem problem{{id, keyframe->pose_revision}, keyframe->data->camera(), keyframe->camera_from_world, {}};
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    if (!keyframe->points[i].valid()) {
      continue;
    }
    const MapPoint& point = map.At(keyframe->points[i]);
    // A point that this keyframe made lies where its pose put it and says nothing about that pose.
    if (point.IsMadeBy(id) || map.probabilities().State(point.id) != PointState::kStatic) {
      continue;
    }
    const double p = map.probabilities().Get(point.id);
    const Keypoint& keypoint = keyframe->data->keypoints()[i];
    problem.observations.push_back({point.position, ObservationOf(keypoint, map.pyramid(), 1.0 - p)});
  }
  if (std::ssize(problem.observations) < options.min_static) {
    return std::nullopt;
  }
  return problem;
}

std::optional<Correction> SemanticCorrection(const SemanticPoseProblem& problem, const PoseResult& result,
                                             const SemanticOptimizerOptions& options) {
  if (!result.converged || result.inliers < options.min_static) {
    return std::nullopt;
  }
  const Rigid3 world_from_camera = result.camera_from_world.Inverse();
  const Rigid3 new_world_from_old_world = world_from_camera * problem.camera_from_world;
  const double rotation_deg = AngleOf(new_world_from_old_world.rotation) * 180.0 / std::numbers::pi;
  const double shift_m = (world_from_camera.translation - problem.camera_from_world.Inverse().translation).norm();
  if (shift_m < options.min_shift_m && rotation_deg < options.min_rotation_deg) {
    return std::nullopt;
  }
  Correction correction;
  correction.poses.push_back({problem.keyframe, result.camera_from_world, true});
  return correction;
}

std::optional<Correction> SolveSemanticPose(const SemanticPoseProblem& problem,
                                            const PoseOptimizerOptions& pose_options,
                                            const SemanticOptimizerOptions& options) {
  return SemanticCorrection(
      problem, OptimizePose(problem.camera, problem.camera_from_world, problem.observations, pose_options), options);
}

}  // namespace rds
