// SPDX-License-Identifier: Apache-2.0
#include "tracking/keyframe_policy.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

// A frame that gives no reason for a keyframe.
KeyframeSituation Calm() {
  KeyframeSituation s;
  s.frames_since_keyframe = 10;
  s.frames_since_recovery = 1000;
  s.mapping_idle = true;
  s.inliers = 98;
  s.reference_tracked_points = 100;
  s.reference_seen = 200;
  s.reference_inliers = 150;
  s.depth_tracked = 200;
  s.depth_untracked = 10;
  return s;
}

TEST(KeyframePolicy, AnUnchangedViewIsNoKeyframe) {
  KeyframeSituation s = Calm();
  EXPECT_FALSE(WantsKeyframe(s, {}));
  s.frames_since_keyframe = 1000;  // time alone is no reason
  EXPECT_FALSE(WantsKeyframe(s, {}));
}

TEST(KeyframePolicy, ANewViewIsAKeyframeWhenMappingIsIdle) {
  const KeyframePolicyOptions options;
  KeyframeSituation s = Calm();
  s.inliers = static_cast<int>(options.tracked_ratio * 100) - 1;
  EXPECT_TRUE(WantsKeyframe(s, options));
  s.mapping_idle = false;
  EXPECT_FALSE(WantsKeyframe(s, options));
  s.frames_since_keyframe = options.max_frames;  // overdue
  EXPECT_TRUE(WantsKeyframe(s, options));
}

TEST(KeyframePolicy, SoonAfterAKeyframeOnlyAViewThatChangesFastMakesAnother) {
  const KeyframePolicyOptions options;
  KeyframeSituation s = Calm();
  s.frames_since_keyframe = options.min_frames - 1;
  s.inliers = static_cast<int>(options.tracked_ratio * 100) - 1;
  EXPECT_FALSE(WantsKeyframe(s, options));
  s.reference_inliers = static_cast<int>(options.shared_ratio * 200) - 1;  // however many new points are tracked
  EXPECT_TRUE(WantsKeyframe(s, options));
}

TEST(KeyframePolicy, ARapidTurnDoesNotWaitForMapping) {
  KeyframeSituation s = Calm();
  s.mapping_idle = false;
  s.reference_tracked_points = 0;  // all points are new
  s.reference_inliers = 99;
  s.frames_since_keyframe = 2;
  EXPECT_TRUE(WantsKeyframe(s, {}));
  s.frames_since_keyframe = 1;
  EXPECT_FALSE(WantsKeyframe(s, {}));
}

// People walk by, or the surface is such: most of the reference's points were never found again.
TEST(KeyframePolicy, PointsThatNoViewSharedAreNotMissed) {
  KeyframeSituation s = Calm();
  s.mapping_idle = false;
  s.frames_since_keyframe = 3;
  s.reference_tracked_points = 400;
  s.reference_inliers = 70;
  s.reference_seen = 80;
  EXPECT_FALSE(WantsKeyframe(s, {}));
  s.reference_seen = 150;
  EXPECT_TRUE(WantsKeyframe(s, {}));
}

TEST(KeyframePolicy, FewPointsWithDepthTrackedWhereMoreCouldBe) {
  KeyframeSituation s = Calm();
  s.mapping_idle = false;
  s.depth_tracked = 99;
  s.depth_untracked = 71;
  EXPECT_TRUE(WantsKeyframe(s, {}));
  s.depth_untracked = 70;
  EXPECT_FALSE(WantsKeyframe(s, {}));
}

TEST(KeyframePolicy, TooFewInliersAreNeverAKeyframe) {
  KeyframeSituation s = Calm();
  s.inliers = 15;
  s.segmenter_idle = true;
  EXPECT_FALSE(WantsKeyframe(s, {}));
  s.inliers = 16;
  EXPECT_TRUE(WantsKeyframe(s, {}));
}

TEST(KeyframePolicy, AnIdleSegmenterGetsAKeyframe) {
  KeyframePolicyOptions options;
  KeyframeSituation s = Calm();
  s.segmenter_idle = true;
  EXPECT_TRUE(WantsKeyframe(s, options));
  s.frames_since_keyframe = options.semantic_frames - 1;
  EXPECT_FALSE(WantsKeyframe(s, options));
  s.frames_since_keyframe = 5;
  options.semantic_frames = 0;
  EXPECT_FALSE(WantsKeyframe(s, options));
}

}  // namespace
}  // namespace rds
