// SPDX-License-Identifier: Apache-2.0
// When a frame becomes a keyframe.
#pragma once

#include "tracking/tracker_options.h"

namespace rds {

// What the policy looks at.
struct KeyframeSituation {
  int frames_since_keyframe = 0;
  int frames_since_recovery = 0;  // since tracking was last recovered; large if never
  bool mapping_idle = false;
  bool segmenter_idle = false;       // semantics run and the backlog holds nothing to label
  int inliers = 0;                   // matches that the pose stands on or could have stood on; no dynamic ones
  int reference_tracked_points = 0;  // confirmed points of the reference keyframe; no dynamic ones
  int reference_inliers = 0;         // its points among the inliers, confirmed or not; no dynamic ones
  int reference_seen = 0;            // the most of them in a frame since it became the reference, this one included
  int depth_tracked = 0;             // keypoints with depth that are matched
  int depth_untracked = 0;           // those that are not
};

// Pure function of its arguments.
[[nodiscard]] bool WantsKeyframe(const KeyframeSituation& situation, const KeyframePolicyOptions& options);

}  // namespace rds
