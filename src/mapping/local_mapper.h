// SPDX-License-Identifier: Apache-2.0
// Local mapping: what a new keyframe does to the map around it.
#pragma once

#include <vector>

#include "map/keyframe_candidate.h"
#include "map/map.h"
#include "map/moving_probability.h"
#include "mapping/local_bundle.h"

namespace rds {

struct MappingOptions {
  double close_baselines = 40;    // points are made from depth below so many baselines ...
  int min_depth_points = 100;     // ... and for at least so many of the nearest keypoints with depth
  int probation_keyframes = 3;    // keyframes for which a new point is on trial
  double min_found_ratio = 0.25;  // of a point on trial
  int min_observations = 2;       // keyframes that must see a point two keyframes after it was made
  int triangulate_neighbors = 10;
  double triangulate_ratio = 0.8;
  int fuse_neighbors = 10;        // best covisible keyframes; each brings its best five
  double redundant_ratio = 0.95;  // of a keyframe's close points seen elsewhere: the keyframe goes
  int redundant_observations = 3;
  int cull_keyframes = 20;  // best covisible keyframes that are examined
  LocalBundleOptions bundle;
};

// The mapping thread's algorithm, in phases that each need the lock of the map for a short time. Knows no thread; one
// instance, one caller.
class LocalMapper {
 public:
  // `probabilities` must outlive the mapper.
  LocalMapper(const MappingOptions& options, const MovingProbabilityOptions& probability_options,
              MovingProbabilities& probabilities);

  // Adds the candidate as a keyframe with the points it tracked and new ones from its depth.
  KeyframeId Insert(Map& map, const KeyframeCandidate& candidate);

  // Ends the trial of young points, triangulates new ones with neighboring keyframes, fuses duplicates.
  void Refine(Map& map, KeyframeId keyframe);

  // Removes keyframes around this one whose points are well seen without them. Returns the removed ones.
  std::vector<KeyframeId> CullKeyframes(Map& map, KeyframeId keyframe);

 private:
  void AddTrackedPoints(Map& map, Keyframe& keyframe, const KeyframeCandidate& candidate);
  void AddDepthPoints(Map& map, Keyframe& keyframe, const KeyframeCandidate& candidate);
  void CullRecentPoints(Map& map, KeyframeId newest);
  void Triangulate(Map& map, KeyframeId keyframe);
  void Fuse(Map& map, KeyframeId keyframe);
  [[nodiscard]] bool IsRedundant(const Map& map, const Keyframe& keyframe) const;

  MappingOptions options_;
  MovingProbabilityOptions probability_options_;
  MovingProbabilities& probabilities_;
  std::vector<PointId> recent_points_;
};

}  // namespace rds
