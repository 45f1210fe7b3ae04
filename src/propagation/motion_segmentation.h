// SPDX-License-Identifier: Apache-2.0
// What moves by itself, told from two views without any network: two-view motion segmentation.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "feature/frame_data.h"
#include "map/correction.h"
#include "map/map.h"

namespace rds {

// What the motion of most of the picture says of a frame's keypoints.
struct MotionSegmentation {
  std::vector<KeypointLabel> labels;  // static: follows it; dynamic: moves otherwise; none: cannot be told
  Rigid3 witness_from_frame;          // that motion
  double share = 0;                   // of the area with matches, what follows it
  double score = 0, expected_share = 0;          // what follows the motion that was expected
  int matches = 0;

  // Whether the picture says that the expected motion is that of something else.
  [[nodiscard]] bool Contradicts() const { return score - expected_share > 0.15; }
};

// Finds the rigid motion between two views that most of the picture follows, and what moves otherwise. Keypoints are
// matched by appearance alone, so that no pose, right or wrong, has a say in it; each match counts by the area of the
// image that it stands for, so that a thing with many corners does not outvote a plain room; and the views must lie
// apart, for between neighboring frames a thing and the far wall behind it have a motion in common. A keypoint
// contradicts if it is far from where that motion takes it, looks unlike what is there, and keypoints beside it say
// the same. `known`: labels of the frame's keypoints (empty: none); dynamic ones are not asked. Nothing where the views
// have too little in common. After RANSAC over 3-D to 3-D alignments (Fischler and Bolles 1981; Umeyama 1991); seeded:
// the same input gives the same labels. Re-entrant.
[[nodiscard]] std::optional<MotionSegmentation> SegmentByMotion(const FrameData& frame,
                                                                std::span<const KeypointLabel> known,
                                                                const FrameData& witness,
                                                                const std::optional<Rigid3>& witness_from_frame,
                                                                const ScalePyramid& pyramid);

// Labels of keyframes before one that was seen to be led astray, after its witness: dynamic on the surfaces whose points
// are dynamic in that one. They have judged them by themselves when these had moved too little to tell.
struct Relabeling {
  KeyframeId keyframe;
  std::shared_ptr<const FrameData> data;
  std::vector<KeypointLabel> seeds;   // what the other keyframe says of the points that both see
  std::vector<KeypointLabel> labels;  // as they are
};
[[nodiscard]] std::vector<Relabeling> PlanRelabeling(const Map& map, FrameId frame, FrameId witness);
[[nodiscard]] std::vector<KeypointLabel> Relabel(const Relabeling& relabeling);

// Writes labels of keypoints into a mask of the recorded image's size, along the surfaces that they lie on: dynamic over
// everything, static over what is unsure.
void DrawSurfaces(const FrameData& data, std::span<const KeypointLabel> labels, Image8& mask);

}  // namespace rds
