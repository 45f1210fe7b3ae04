// SPDX-License-Identifier: Apache-2.0
// The way of a mask's labels to the keyframe that they speak of.
#pragma once

#include <vector>

#include "map/map_access.h"
#include "propagation/free_space.h"

namespace rds {

// Labels the keyframe made from a frame: by its mask, and dynamic where the free space that earlier keyframes saw is
// occupied now. Kept in the map if the keyframe is still to come, dropped if it is gone.
// `certain`: as in Map::Label.
void LabelKeyframe(MapAccess& map, FrameId frame, std::vector<KeypointLabel> labels, bool certain,
                   const FreeSpaceOptions& options);

}  // namespace rds
