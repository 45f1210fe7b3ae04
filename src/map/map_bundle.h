// SPDX-License-Identifier: Apache-2.0
// Part of a map as a bundle adjustment takes it, and its outcome as the map takes it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "map/map.h"
#include "optim/bundle_adjustment.h"

namespace rds {

// A copy of some keyframes and the points that they see.
struct MapBundle {
  struct Point {
    PointId id;
    std::uint32_t revision = 0;
    KeyframeVersion reference;
  };
  BundleProblem problem;
  std::vector<KeyframeVersion> keyframes;  // one for each pose of the problem
  std::vector<Point> points;               // one for each point of the problem
};

// All keyframes of a world; every n-th, ascending, where covisibility has more edges than so many: the memory and the
// time of a bundle adjustment grow with them.
[[nodiscard]] std::vector<KeyframeId> KeyframesToAdjust(const Map& map, WorldId world, std::size_t most_edges);

// The points that keyframes see, ascending; `weighted`: without those known as dynamic, which constrain nothing.
[[nodiscard]] std::vector<PointId> PointsToAdjust(const Map& map, std::span<const KeyframeId> keyframes, bool weighted);

// Copies out keyframes that are to be adjusted, others that are held fixed, and what they see of `points`. Roots of
// worlds are fixed; if nothing is, the first keyframe is. `weighted`: residuals have the weight 1 - p (equation 6 of
// the paper). Nothing if there is nothing to adjust.
[[nodiscard]] std::optional<MapBundle> PlanBundle(const Map& map, std::span<const KeyframeId> adjusted,
                                                  std::span<const KeyframeId> fixed, std::span<const PointId> points,
                                                  bool weighted);

// Bends a world to the outcome of a bundle adjustment of all of it: keyframes made meanwhile follow their parents,
// points that have changed meanwhile their hosts; outliers are forgotten.
void BendTo(Map& map, const MapBundle& bundle, const BundleResult& result);

}  // namespace rds
