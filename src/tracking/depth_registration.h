// SPDX-License-Identifier: Apache-2.0
// Registration of two depth images: point-to-plane ICP.
#pragma once

#include <cstdint>
#include <span>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"
#include "optim/pose_prior.h"
#include "place/explained_share.h"
#include "tracking/tracker_options.h"

namespace rds {

// Every second sample of the depth grid in each direction is registered, from the second on.
inline constexpr int kRegistrationStep = kExplainedStep;

// Registers the depth grid of a frame to that of another view: point-to-plane ICP with projective association (Chen and
// Medioni 1992; Blais and Levine 1995), starting at the mean of the prior and held near it. Returns what is then known
// of the pose of the frame: the prior itself if too little overlaps, and no more than the prior said along directions
// that the surfaces leave free. `usable`: 1 for each sample of the frame that may be used; empty = all. Where points
// are few, near or side by side, this keeps a pose from turning about them. Distortion of the lens, a few pixels and
// the same in both views, is not taken out. Re-entrant.
[[nodiscard]] PosePrior RegisterDepth(const FrameData& frame, std::span<const std::uint8_t> usable,
                                      const FrameData& view, const Rigid3& view_from_world, const PosePrior& prior,
                                      const DepthRegistrationOptions& options);

}  // namespace rds
