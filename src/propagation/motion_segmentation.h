// SPDX-License-Identifier: Apache-2.0
// What moves by itself, told from two views without any network: two-view motion segmentation.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "feature/frame_data.h"
#include "map/keyframe.h"

namespace rds {

// What the motion of most of the picture says of a frame's keypoints.
struct MotionSegmentation {
  std::vector<KeypointLabel> labels;  // static: follows it; dynamic: moves otherwise; none: cannot be told
  bool contradicts = false;           // that motion is not the expected one, which is then that of something else
};

// Finds the rigid motion between two views that most of the picture follows, and what moves otherwise. No pose, right
// or wrong, has a say in it: keypoints are matched by appearance alone (FindMotions). Nor have a thing's many corners:
// surfaces are counted, not corners (CompareMotions). The views must lie apart, for between neighboring frames a thing
// and the far wall behind it have a motion in common. A keypoint contradicts if it is far from where that motion takes
// it, looks unlike what is there, and keypoints beside it say the same. `known`: labels of the frame's keypoints
// (empty: none); dynamic ones are not asked. `expected`: the motion (witness_from_frame) that the poses say there was.
// Nothing where the views have too little in common, or where no motion has clearly more of the picture than another.
// The same input gives the same labels. Re-entrant.
[[nodiscard]] std::optional<MotionSegmentation> SegmentByMotion(const FrameData& frame,
                                                                std::span<const KeypointLabel> known,
                                                                const FrameData& witness,
                                                                const std::optional<Rigid3>& expected,
                                                                const ScalePyramid& pyramid);

// Writes labels of keypoints into a mask of the recorded image's size, along the surfaces that they lie on: dynamic
// over everything, static over what is unsure.
void DrawSurfaces(const FrameData& data, std::span<const KeypointLabel> labels, Image8& mask);

}  // namespace rds
