// SPDX-License-Identifier: Apache-2.0
// How far an estimated trajectory is from the ground truth: ATE and RPE, as the TUM RGB-D benchmark defines them
// (Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012) and the evo package computes them.
#pragma once

#include <cstdint>
#include <vector>

#include "eval/statistics.h"
#include "eval/trajectory_matching.h"
#include "geometry/alignment.h"
#include "geometry/trajectory.h"

namespace rds {

enum class DeltaUnit : std::uint8_t { kSeconds, kFrames };

struct EvaluationOptions {
  bool with_scale = false;         // align with a similarity instead of a rigid transform
  bool interpolate = false;        // the ground truth between its poses, instead of the nearest pose
  double max_difference_s = 0.01;  // of times, nearest pose (evo's default)
  double max_gap_s = 0.2;          // between neighbors of the ground truth, interpolation
  double delta = 1;                // of the RPE
  DeltaUnit delta_unit = DeltaUnit::kSeconds;
};

// Matched poses, the estimate's aligned to the ground truth, and what is left between them.
struct Evaluation {
  EvaluationOptions options;
  std::size_t estimate_poses = 0;
  std::size_t ground_truth_poses = 0;
  Alignment ground_truth_from_estimate;
  std::vector<MatchedPose> matches;      // estimate aligned
  Trajectory ground_truth;               // over the time of the matches
  std::vector<double> position_error_m;  // one for each match
  Statistics ate_m;                      // of position_error_m
  // Relative pose error over all pairs of matches (i, j) that are `delta` apart. In frames: j = i + delta. In seconds:
  // j > i is the match whose time is nearest to that of i plus delta, if off by less than three quarters of the median
  // interval of the matches (so no pair reaches into a gap or past the end). With Q the ground truth and P the aligned
  // estimate, of (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) the translation's norm and the rotation's angle. No pairs: counts are 0.
  Statistics rpe_translation_m;
  Statistics rpe_rotation_deg;
};

// InputError if fewer than three poses match in time or the options make no sense.
Evaluation Evaluate(const Trajectory& estimate, const Trajectory& ground_truth, const EvaluationOptions& options = {});

}  // namespace rds
