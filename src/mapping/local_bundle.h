// SPDX-License-Identifier: Apache-2.0
// The local bundle adjustment's way out of the map and back.
#pragma once

#include <vector>

#include "map/map.h"
#include "map/moving_probability.h"
#include "optim/bundle_adjustment.h"

namespace rds {

struct LocalBundleOptions {
  int keyframes = 20;         // optimized at most: the newest and its best covisible ones
  int fixed_keyframes = 20;   // others that see the same points, held fixed, at most
  bool weighted = true;       // residuals weighted by 1 - p (equation 6), points known as dynamic left out
  bool labeled_only = false;  // only keyframes with semantic information, once there are enough
  int enough_labeled = 3;     // keyframes; with fewer the newest keyframes take part without labels
  BundleOptions solver;
};

// A copy of the window around a keyframe, with what is needed to write the result back.
struct LocalBundle {
  BundleProblem problem;
  std::vector<KeyframeId> keyframes;     // one for each pose of the problem
  std::vector<std::uint32_t> revisions;  // Keyframe::pose_revision when copied
  std::vector<PointId> points;           // one for each point of the problem
  bool worthwhile = false;               // false: nothing to optimize
};

// Copies the window out. `semantics`: labels are expected at all. Needs the lock of the map.
[[nodiscard]] LocalBundle CopyLocalBundle(const Map& map, KeyframeId center, bool semantics,
                                          const MovingProbabilities& probabilities,
                                          const MovingProbabilityOptions& probability_options,
                                          const LocalBundleOptions& options);

// Writes back what is still valid: poses not changed by others since, points that live, outliers unlinked. Needs the
// lock of the map.
void ApplyLocalBundle(Map& map, const LocalBundle& bundle, const BundleResult& result);

}  // namespace rds
