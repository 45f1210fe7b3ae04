// SPDX-License-Identifier: Apache-2.0
// Which of two motions more of the picture follows.
#pragma once

#include <span>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"
#include "map/keyframe.h"

namespace rds {

// Shares of a frame's picture, 0 to 1.
struct MotionShares {
  double one = 0;    // follows that motion, and not the other
  double other = 0;  // the other way round
};

// Compares two motions (witness_from_frame). Each keypoint that is found again where one of them takes it, and not
// where the other does, stands for the surface that it lies on, up to the next one: a plain wall has few corners, and
// they are found again less often than those of a thing that is carried along. What has no depth is far. `known`:
// labels of the keypoints (empty: none); dynamic ones are not asked. Zeros without a depth grid. Re-entrant.
[[nodiscard]] MotionShares CompareMotions(const FrameData& frame, std::span<const KeypointLabel> known,
                                          const FrameData& witness, const Rigid3& one, const Rigid3& other,
                                          const ScalePyramid& pyramid);

// The same where each keypoint has been judged: static ones follow the motion, dynamic ones do not.
[[nodiscard]] MotionShares ShareSurfaces(const FrameData& frame, std::span<const KeypointLabel> keypoints);

}  // namespace rds
