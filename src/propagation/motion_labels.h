// SPDX-License-Identifier: Apache-2.0
// What moves by itself, in the masks and labels of keyframes.
#pragma once

#include <optional>

#include "base/image.h"
#include "map/map_access.h"
#include "propagation/recent_frames.h"

namespace rds {

// A keyframe whose pose follows what moves, as the view of another frame tells.
struct LedAstray {
  FrameId frame;
  FrameId witness;
};

// Compares a frame that is being labeled with recent ones (SegmentByMotion): what moves otherwise than most of the
// picture becomes dynamic in its mask, what follows it static where the mask is unsure. Says so if most of the picture
// contradicts the poses that the map has of them.
[[nodiscard]] std::optional<LedAstray> MarkMoving(const MapAccess& map, const RecentFrames& recent,
                                                  const RecentFrames::Entry& frame, const ScalePyramid& pyramid,
                                                  Image8& mask);

// Labels the keyframes between a witness and a labeled one that was led astray again: dynamic on the surfaces of which
// that one says so. By themselves they judged when too little had moved to tell.
void LabelAgain(MapAccess& map, const LedAstray& astray);

}  // namespace rds
