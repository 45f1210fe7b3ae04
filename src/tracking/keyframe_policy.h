// SPDX-License-Identifier: Apache-2.0
// When a frame becomes a keyframe.
#pragma once

#include <cstdint>

namespace rds {

enum class KeyframeRule : std::uint8_t { kOrbSlam3, kPaper };

struct KeyframePolicyOptions {
  KeyframeRule rule = KeyframeRule::kOrbSlam3;  // or the paper's (section II-A1)
  int max_frames = 30;                          // orb_slam3: a keyframe at the latest after so many frames
  int min_frames = 6;           // none sooner than so many frames after the last, unless tracking is weak
  double tracked_ratio = 0.95;  // of the reference keyframe's points: below this the view is new
  double weak_ratio = 0.25;     // below this a keyframe is wanted even while mapping is busy
  int close_tracked = 100;      // fewer close points tracked than this ...
  int close_untracked = 70;     // ... while more than this could be: a keyframe is wanted
  int min_inliers = 15;
  int paper_frames = 20;  // paper: frames since the last keyframe or recovery
  int paper_points = 50;
  double paper_ratio = 0.9;
  int semantic_frames = 8;  // with semantics: a keyframe for an idle segmenter, at most so often; 0 = never
};

// What the policy looks at.
struct KeyframeSituation {
  int frames_since_keyframe = 0;
  int frames_since_recovery = 0;  // since tracking was last recovered; large if never
  bool mapping_idle = false;
  bool segmenter_idle = false;       // semantics run and the backlog holds nothing to label
  int inliers = 0;                   // matches that the pose stands on or could have stood on; no dynamic ones
  int reference_tracked_points = 0;  // confirmed points of the reference keyframe; no dynamic ones
  int close_tracked = 0;             // close keypoints with depth that are matched
  int close_untracked = 0;           // close keypoints with depth that are not
};

// Pure function of its arguments.
[[nodiscard]] bool WantsKeyframe(const KeyframeSituation& situation, const KeyframePolicyOptions& options);

}  // namespace rds
