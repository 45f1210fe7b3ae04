// SPDX-License-Identifier: Apache-2.0
// The semantic-based optimization: the paper's section VI-A.
#pragma once

#include <optional>
#include <vector>

#include "map/map.h"
#include "map/moving_probability.h"
#include "optim/pose_optimizer.h"

namespace rds {

struct SemanticOptimizerOptions {
  bool enabled = true;
  int most_keyframes = 30;         // a labeled one and those after it, whose poses hang on its own
  int min_static = 50;             // static matches that a keyframe needs
  double min_shift_m = 0.002;      // smaller corrections are not written: they are noise ...
  double min_rotation_deg = 0.05;  // ... unless the rotation is larger than this
};

// One keyframe's matches to static points that older keyframes made, copied out of the map.
struct SemanticPoseProblem {
  KeyframeId keyframe;
  std::uint32_t revision = 0;  // Keyframe::pose_revision when copied
  PinholeCamera camera;
  Rigid3 camera_from_world;
  std::vector<PoseObservation> observations;  // weighted by 1 - p, equation 6
};

// Nothing if the keyframe is gone, the root, or has too few such matches. Needs the lock of the map. Keyframes are to
// be corrected in their order: then older ones stand where they belong, and so do their points.
[[nodiscard]] std::optional<SemanticPoseProblem> CopyStaticMatches(const Map& map, KeyframeId keyframe,
                                                                   const MovingProbabilities& probabilities,
                                                                   const MovingProbabilityOptions& probability_options,
                                                                   const SemanticOptimizerOptions& options);

// Writes the pose back if nobody changed it since, and moves along the points that this keyframe made.
// Returns whether anything was written. Needs the lock of the map.
bool ApplySemanticPose(Map& map, const SemanticPoseProblem& problem, const PoseResult& result,
                       const SemanticOptimizerOptions& options);

}  // namespace rds
