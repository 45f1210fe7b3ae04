// SPDX-License-Identifier: Apache-2.0
// The semantic-based optimization: the paper's section VI-A.
#pragma once

#include <optional>
#include <vector>

#include "map/map.h"
#include "optim/pose_optimizer.h"
#include "semantic/semantic_options.h"

namespace rds {

// One keyframe's matches to static points that older keyframes made, copied out of the map.
struct SemanticPoseProblem {
  KeyframeVersion keyframe;
  PinholeCamera camera;
  Rigid3 camera_from_world;
  std::vector<PoseObservation> observations;  // weighted by 1 - p, equation 6
};

// Nothing if the keyframe is gone, a root, or has too few such matches. Keyframes are to be corrected in their order:
// then older ones stand where they belong, and so do their points.
[[nodiscard]] std::optional<SemanticPoseProblem> PlanSemanticPose(const Map& map, KeyframeId keyframe,
                                                                  const SemanticOptimizerOptions& options);

// The correction to an optimized pose, which the points that the keyframe made follow. Nothing where too few matches
// agree with it, or where it is no more than noise.
[[nodiscard]] std::optional<Correction> SemanticCorrection(const SemanticPoseProblem& problem, const PoseResult& result,
                                                           const SemanticOptimizerOptions& options);

// Optimizes the pose over the static matches: SemanticCorrection of that.
[[nodiscard]] std::optional<Correction> SolveSemanticPose(const SemanticPoseProblem& problem,
                                                          const PoseOptimizerOptions& pose_options,
                                                          const SemanticOptimizerOptions& options);

}  // namespace rds
