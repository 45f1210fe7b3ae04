// SPDX-License-Identifier: Apache-2.0
// Local bundle adjustment: poses and points around a keyframe refined together.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "map/map.h"
#include "mapping/mapping_options.h"
#include "optim/bundle_adjustment.h"

namespace rds {

// A copy of the window around a keyframe.
struct LocalBundle {
  struct Point {
    PointId id;
    std::uint32_t revision = 0;
    KeyframeVersion reference;
  };
  BundleProblem problem;
  std::vector<KeyframeVersion> keyframes;  // one for each pose of the problem
  std::vector<Point> points;               // one for each point of the problem
};

// Copies the window out. `semantics`: labels are expected at all. Nothing if there is nothing to optimize.
[[nodiscard]] std::optional<LocalBundle> PlanLocalBundle(const Map& map, KeyframeId center, bool semantics,
                                                         const LocalBundleOptions& options);

// Poses and points after bundle adjustment, outliers removed. Nothing if it was stopped before it found anything.
[[nodiscard]] std::optional<Correction> SolveLocalBundle(const LocalBundle& bundle, const BundleOptions& options,
                                                         const std::function<bool()>& should_stop = {});

}  // namespace rds
