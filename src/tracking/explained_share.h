// SPDX-License-Identifier: Apache-2.0
// What two depth images say of a pose between them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"
#include "tracking/depth_registration.h"

namespace rds {

// Share, 0 to 1, of the samples of a frame's depth grid that another view of the same camera confirms: one is confirmed
// where that view saw a surface at its place, contradicted where it looked through that place; what it could not see
// does not count. Matches may agree on the motion of a thing that fills few pixels; the rest of the image does not.
// `usable` marks the samples that are asked, every kRegistrationStep-th being enough; empty = all. Nothing where fewer
// than fifty can be judged. Re-entrant.
[[nodiscard]] std::optional<double> ExplainedShare(const FrameData& frame, std::span<const std::uint8_t> usable,
                                                   const FrameData& view, const Rigid3& view_from_frame);

}  // namespace rds
