// SPDX-License-Identifier: Apache-2.0
// Which matches a pose may stand on: the paper's Algorithm 2.
#pragma once

#include <span>
#include <vector>

#include "map/local_map.h"
#include "map/moving_probability.h"
#include "map/point_match.h"
#include "propagation/label_propagation.h"
#include "tracking/tracker_options.h"

namespace rds {

// Outcome of Algorithm 2. `used` holds static matches before unknown ones.
struct Association {
  std::vector<PointMatch> used;
  std::vector<PointMatch> deferred;  // unknown ones not needed
  std::vector<PointMatch> dynamic;   // never used
  int static_count = 0;              // how many of `used` are static
};

// Classifies matches by the probabilities of this moment and selects the ones to use. A point of unknown state has the
// probability of its keypoint (null: no labels). Re-entrant.
[[nodiscard]] Association SelectMatches(std::span<const PointMatch> matches, const LocalMap& map,
                                        const MovingProbabilities& probabilities,
                                        const KeypointProbabilities* propagated, const AssociationOptions& options);

}  // namespace rds
