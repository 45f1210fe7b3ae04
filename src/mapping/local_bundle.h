// SPDX-License-Identifier: Apache-2.0
// Local bundle adjustment: poses and points around a keyframe refined together.
#pragma once

#include <functional>
#include <optional>

#include "map/map_bundle.h"
#include "mapping/mapping_options.h"

namespace rds {

// Copies the window out. `semantics`: labels are expected at all. Nothing if there is nothing to optimize.
[[nodiscard]] std::optional<MapBundle> PlanLocalBundle(const Map& map, KeyframeId center, bool semantics,
                                                       const LocalBundleOptions& options);

// Poses and points after bundle adjustment, outliers removed. Nothing if it was stopped before it found anything.
[[nodiscard]] std::optional<Correction> SolveLocalBundle(const MapBundle& bundle, const BundleOptions& options,
                                                         const std::function<bool()>& should_stop = {});

}  // namespace rds
