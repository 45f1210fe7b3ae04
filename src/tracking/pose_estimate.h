// SPDX-License-Identifier: Apache-2.0
// The pose of a frame from matches to the local map.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "map/local_map.h"
#include "optim/pose_optimizer.h"
#include "propagation/label_propagation.h"
#include "tracking/data_association.h"
#include "tracking/tracker_options.h"

namespace rds {

// What tracking takes over from other modules.
struct TrackerSetup {
  PoseOptimizerOptions pose;
  SurfaceLabelOptions surface;  // of the labels that Tracker::Track is given
  bool semantics = true;        // labels are expected at all
  ScalePyramid pyramid = ScalePyramid();
};

// Wall time of the stages, milliseconds.
struct StageTimes {
  double matching_ms = 0;
  double pose_ms = 0;
  double local_map_ms = 0;
};

// Everything that the stages of tracking one frame read, and where they add up their times. References outlive it.
struct FrameContext {
  const FrameData& data;
  const LocalMap& map;
  const MovingProbabilities& probabilities;
  const KeypointProbabilities* propagated = nullptr;  // of the frame's keypoints; null without labels
  const TrackerOptions& options;
  const TrackerSetup& setup;
  StageTimes& times;
};

// A pose and the matches that it stands on.
struct PoseEstimate {
  Rigid3 camera_from_world;
  std::optional<PosePrior> prior;    // that it was found with; later optimizations keep it
  Association association;           // `used` are inliers
  std::vector<PointMatch> outliers;  // of the optimizations so far
};

// Algorithm 2 for matches of the frame.
[[nodiscard]] Association Select(const FrameContext& frame, std::span<const PointMatch> matches);

// Optimizes a pose from the matches that Algorithm 2 lets through, beginning at `initial`.
[[nodiscard]] PoseEstimate EstimatePose(const FrameContext& frame, const Rigid3& initial,
                                        const std::optional<PosePrior>& prior, std::span<const PointMatch> matches);

// Resolves the matches that were deferred: those that do not agree with the pose are outliers; the others are let in
// and the pose is optimized again where static matches are few (UnknownPoints::kDeferred).
void ResolveDeferred(const FrameContext& frame, PoseEstimate& estimate);

}  // namespace rds
