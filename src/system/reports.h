// SPDX-License-Identifier: Apache-2.0
// What goes in is checked, what comes out is filled in: the two ends of Slam::Process, and Slam::Finish.
#pragma once

#include <optional>

#include "geometry/camera.h"
#include "system/frame.h"
#include "system/lanes.h"
#include "tracking/tracker.h"

namespace rds {

// Throws InputError if an image is missing or of a wrong kind or size, or the timestamp not after the last one.
void CheckFrame(const RgbdFrame& frame, const PinholeCamera& camera, std::optional<double> last_timestamp_s);

// Pose, counts, map size, times and, where wanted, the features of a frame; result->frame is set already.
void FillFrameResult(const TrackOutcome& outcome, const FrameData& data, const Lanes& lanes, bool features,
                     FrameResult* result);

// What the lanes did and what the map holds, after they have ended.
void FillSlamResult(const Lanes& lanes, SlamResult* result);

}  // namespace rds
