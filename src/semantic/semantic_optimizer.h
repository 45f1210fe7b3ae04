// The semantic-based optimisation: the paper's section VI-A.
#pragma once

#include <optional>
#include <vector>

#include "map/map.h"
#include "optim/pose_optimizer.h"
#include "semantic/moving_probability.h"

namespace rds {

struct SemanticOptimizerOptions {
  bool enabled = true;
  int min_static = 50;         // static matches that a keyframe needs
  double min_shift_m = 0.002;  // smaller corrections are not written: they are noise ...
  double min_turn_deg = 0.05;  // ... unless the rotation is larger than this
};

// One keyframe's static matches, copied out of the map.
struct SemanticPoseProblem {
  KeyframeId keyframe;
  std::uint32_t revision = 0;  // Keyframe::pose_revision when copied
  PinholeCamera camera;
  Rigid3 camera_from_world;
  std::vector<PoseObservation> observations;  // weighted by 1 - p, equation 6
};

// Nothing if the keyframe is gone or has too few static matches. Needs the door of the map.
[[nodiscard]] std::optional<SemanticPoseProblem> CopyStaticMatches(const Map& map, KeyframeId keyframe,
                                                                   const MovingProbabilities& probabilities,
                                                                   const MovingProbabilityOptions& probability_options,
                                                                   const SemanticOptimizerOptions& options);

// Writes the pose back if nobody changed it since, and moves along the points that hang on this keyframe alone.
// Returns whether anything was written. Needs the door of the map.
bool ApplySemanticPose(Map& map, const SemanticPoseProblem& problem, const PoseResult& result,
                       const SemanticOptimizerOptions& options);

}  // namespace rds
