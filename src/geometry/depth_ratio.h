// SPDX-License-Identifier: Apache-2.0
// When two depths are those of one surface.
#pragma once

#include <algorithm>

#include "geometry/camera.h"

// How far two depths of one surface may differ by the slope of surfaces between samples and by motion, as a ratio of
// the depth: one table for all that asks. What options set is listed with its default.
namespace rds::depth_ratio {

inline constexpr float kSamePlace = 0.03F;     // where a later view shows a place
inline constexpr float kMovingPlace = 0.06F;   // the same of what moves, from one frame to the next
inline constexpr double kNextSample = 0.03;    // neighboring samples (propagation.depth_step_ratio)
inline constexpr double kStaticAgain = 0.02;   // a static surface seen again (semantic.free_space_match)
inline constexpr double kLookedBeyond = 0.10;  // none was there: seen so far beyond (semantic.free_space_margin)

}  // namespace rds::depth_ratio

namespace rds {

// The same in meters, and no less than what the sensor does not know: so many standard deviations of its noise.
[[nodiscard]] inline float SurfaceTolerance_m(const DepthNoiseModel& noise, float depth_m, float ratio, double sigmas) {
  return std::max(ratio * depth_m, static_cast<float>(sigmas * noise.Sigma_m(static_cast<double>(depth_m))));
}

}  // namespace rds
