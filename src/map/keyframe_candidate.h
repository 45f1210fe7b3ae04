// SPDX-License-Identifier: Apache-2.0
// A tracked frame on its way to become a keyframe.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"
#include "geometry/rigid3.h"

namespace rds {

// How often a point was in view and matched since the last keyframe.
struct PointUse {
  PointId point;
  int visible = 0;
  int found = 0;
};

// Made by tracking, taken by mapping. A value.
struct KeyframeCandidate {
  FrameId frame;
  double timestamp_s = 0;
  std::shared_ptr<const FrameData> data;
  KeyframeId reference;                // invalid for the very first
  Rigid3 camera_from_reference;        // pose; in the world if there is no reference
  std::vector<PointId> points;         // one for each keypoint, invalid = none
  std::vector<std::uint32_t> blocked;  // keypoints that showed dynamic points: no new point is made there
  std::vector<double> probabilities;   // moving probability that a new point starts from; empty without semantics
  std::vector<PointUse> uses;          // since the keyframe before
};

}  // namespace rds
