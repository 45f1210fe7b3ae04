// SPDX-License-Identifier: Apache-2.0
// Which matches a pose may stand on: the paper's Algorithm 2.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "map/local_map.h"
#include "map/moving_probability.h"

namespace rds {

enum class UnknownPoints : std::uint8_t {
  kPaper,     // used only while fewer than tau static ones are there
  kAlways,    // always used, with the weight 1 - p that lets static ones lead
  kDeferred,  // used where static ones are few, but only those that agree with their pose; all of them if static ones
              // are too few for a pose
};

struct AssociationOptions {
  bool use_semantics = true;  // false: every match is used, as if no point had a label
  int tau = 20;               // static matches that are enough
  UnknownPoints unknown = UnknownPoints::kDeferred;
  int min_static_inliers = 60;  // kDeferred: below so many static inliers unknown ones are let in
  int min_static_matches = 10;  // kDeferred: so many static matches give a pose of their own
  int min_observations = 4;     // with semantics, a point that fewer keyframes see has proportionally less weight
};

// A keypoint of the current frame and the point of the local map that it shows.
struct PointMatch {
  std::uint32_t keypoint = 0;
  std::uint32_t point = 0;  // index into LocalMap
  PointState state = PointState::kUnknown;
  double weight =
      1;  // 1 - p, less for a point that is not proven, scaled so that the best match that is used has weight 1
};

// Outcome of Algorithm 2. `used` holds static matches before unknown ones.
struct Association {
  std::vector<PointMatch> used;
  std::vector<PointMatch> deferred;  // unknown ones not needed
  std::vector<PointMatch> dynamic;   // never used
  int static_count = 0;              // how many of `used` are static
};

// Classifies matches by the probabilities of this moment and selects the ones to use. A point of unknown state has the
// probability of its keypoint (none: no labels). Re-entrant.
[[nodiscard]] Association SelectMatches(std::span<const PointMatch> matches, const LocalMap& map,
                                        const MovingProbabilities& probabilities,
                                        const std::function<double(std::uint32_t)>& keypoint_probability,
                                        const AssociationOptions& options);

}  // namespace rds
