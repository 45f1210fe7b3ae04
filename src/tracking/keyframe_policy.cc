// SPDX-License-Identifier: Apache-2.0
#include "tracking/keyframe_policy.h"

namespace rds {
namespace {

// ORB-SLAM3's conditions for RGB-D, a reason of time or need and a view that has changed; and one of our own: in a
// rapid turn all points are new, none of them confirmed, and what the reference keyframe still shares with the view
// says it, over what it shared before, as many of its points are not found again in any view.
bool OrbSlam3Rule(const KeyframeSituation& s, const KeyframePolicyOptions& o) {
  constexpr int kTurnFrames = 2;  // none sooner than this in a turn
  if (s.inliers <= o.min_inliers) {
    return false;
  }
  const bool turned = s.frames_since_keyframe >= kTurnFrames && s.reference_inliers < o.shared_ratio * s.reference_seen;
  const bool few_tracked = s.depth_tracked < o.depth_tracked && s.depth_untracked > o.depth_untracked;
  const bool due =
      s.frames_since_keyframe >= o.max_frames || (s.mapping_idle && s.frames_since_keyframe >= o.min_frames);
  const bool new_view = s.inliers < o.tracked_ratio * s.reference_tracked_points;
  return turned || few_tracked || (due && new_view);
}

}  // namespace

bool WantsKeyframe(const KeyframeSituation& s, const KeyframePolicyOptions& o) {
  if (s.frames_since_recovery < 1) {
    return false;  // a pose found anew is not to be built on before another frame agrees
  }
  // A segmenter with nothing to do is a label lost: the fresher the keyframe it gets, the shorter the semantic delay.
  if (o.semantic_frames > 0 && s.segmenter_idle && s.frames_since_keyframe >= o.semantic_frames &&
      s.inliers > o.min_inliers) {
    return true;
  }
  return OrbSlam3Rule(s, o);
}

}  // namespace rds
