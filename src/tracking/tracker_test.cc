// SPDX-License-Identifier: Apache-2.0
#include "tracking/tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "testing/matchers.h"
#include "testing/point_world.h"

namespace rds {
namespace {

constexpr std::uint32_t kPoints = 400;

Rigid3 Truth(double frame) { return {ExpSo3({0, 0.004 * frame, 0}), {-0.01 * frame, 0.002 * frame, 0}}; }

// A tracker in a world whose first frame is the first keyframe.
struct Scene {
  PointWorld world{kPoints};
  Map map{ScalePyramid()};
  TrackerOptions options;
  std::unique_ptr<Tracker> tracker;
  std::shared_ptr<const LocalMap> local;
  std::uint32_t frames = 0;

  explicit Scene(const TrackerOptions& wanted = {}) : options(wanted) {
    tracker = std::make_unique<Tracker>(options, TrackerSetup{}, map.probabilities());
  }
  TrackOutcome Track(const PointWorld::View& view) {
    const FrameId id{frames++};
    return tracker->Track(id, id.value / 30.0, view.data, local, {}, nullptr);
  }
  TrackOutcome Track(const Rigid3& pose) { return Track(world.Look(pose)); }
  // The first frame becomes the first keyframe, of the points before `last`.
  void Start(std::uint32_t last = kPoints) { Start(world.Look(Truth(0), 0, last)); }
  void Start(const PointWorld::View& view) {
    const TrackOutcome outcome = Track(view);
    ASSERT_TRUE(outcome.tracked && outcome.wants_keyframe);
    EXPECT_FALSE(outcome.reference.valid());
    world.AddTo(map, FrameId{0}, Truth(0), view);
    tracker->KeyframeTaken();
    Publish();
  }
  void Publish() { local = BuildLocalMap(map, map.newest(), {}); }
};

// The same in front of a wall.
PointWorld::View WithWall(const PointWorld::View& view, float depth_m) {
  constexpr int kColumns = 80;
  constexpr int kRows = 60;
  const auto keypoints = view.data->keypoints();
  const auto descriptors = view.data->descriptors();
  return {std::make_shared<const FrameData>(
              TestCamera(), std::vector<Keypoint>(keypoints.begin(), keypoints.end()),
              std::vector<Descriptor>(descriptors.begin(), descriptors.end()),
              DepthGrid(kColumns, kRows, std::vector<float>(std::size_t{kColumns} * kRows, depth_m))),
          view.points};
}

TEST(Tracker, StartsWhereThereIsEnoughDepth) {
  Scene scene;
  EXPECT_FALSE(scene.Track(scene.world.Look({}, 0, 50)).tracked);
  EXPECT_FALSE(scene.Track(scene.world.Look({}, 0, 50)).wants_keyframe);
  EXPECT_TRUE(scene.Track(scene.world.Look({})).tracked);
}

TEST(Tracker, FollowsACameraAndHangsItOnItsKeyframe) {
  Scene scene;
  scene.Start();
  for (int frame = 1; frame < 30; ++frame) {
    const TrackOutcome outcome = scene.Track(Truth(frame));
    ASSERT_TRUE(outcome.tracked) << frame;
    EXPECT_THAT(outcome.camera_from_world, RigidNear(Truth(frame), 1e-3, 0.02)) << frame;
    EXPECT_EQ(outcome.reference, KeyframeId{0});
    EXPECT_GT(outcome.used.size(), 200U);
  }
}

TEST(Tracker, FollowsItsKeyframeWhereThatIsMoved) {
  Scene scene;
  scene.Start();
  for (int frame = 1; frame < 5; ++frame) {
    ASSERT_TRUE(scene.Track(Truth(frame)).tracked);
  }
  const Rigid3 old_from_new{ExpSo3({0, 0, 0.4}), {2, 0, 0}};
  Correction correction;
  correction.poses.push_back({{KeyframeId{0}, 0}, Truth(0) * old_from_new, true});
  ASSERT_EQ(scene.map.Apply(correction).poses, 1);
  scene.Publish();
  const TrackOutcome outcome = scene.Track(Truth(5));
  ASSERT_TRUE(outcome.tracked);
  EXPECT_THAT(outcome.camera_from_world, RigidNear(Truth(5) * old_from_new, 1e-3, 0.02));
}

TEST(Tracker, StandsOnStaticPointsAndNeverOnDynamicOnes) {
  Scene scene;
  scene.Start();
  constexpr std::uint32_t kMoving = 240;  // more than half
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    if (scene.world.IdOf(i).valid()) {
      scene.map.SetMovingProbability(scene.world.IdOf(i), i < kMoving ? 0.9 : 0.1);
    }
  }
  for (int frame = 1; frame < 20; ++frame) {
    scene.world.Move(0, kMoving, {0.005, 0, 0});
    const TrackOutcome outcome = scene.Track(Truth(frame));
    ASSERT_TRUE(outcome.tracked) << frame;
    EXPECT_THAT(outcome.camera_from_world, RigidNear(Truth(frame), 2e-3, 0.05)) << frame;
    EXPECT_TRUE(std::ranges::all_of(outcome.used, [](const auto& m) { return m.state == PointState::kStatic; }));
    if (frame == 1) {  // later they are out of the window that is searched
      EXPECT_GT(outcome.rejected.size(), 50U);
    }
  }
}

TEST(Tracker, IsLostWhereNothingIsKnownAndRecovers) {
  Scene scene;
  scene.Start();
  for (int frame = 1; frame < 5; ++frame) {
    ASSERT_TRUE(scene.Track(Truth(frame)).tracked);
  }
  const PointWorld elsewhere(kPoints, 99);
  for (int frame = 0; frame < 3; ++frame) {
    const TrackOutcome outcome = scene.Track(elsewhere.Look(Truth(0)));
    EXPECT_FALSE(outcome.tracked || outcome.wants_keyframe);
  }
  const Rigid3 far{ExpSo3({0, 0.1, 0.3}), {-0.3, 0.1, 0.2}};  // no motion model leads there
  const TrackOutcome outcome = scene.Track(far);
  ASSERT_TRUE(outcome.tracked);
  EXPECT_THAT(outcome.camera_from_world, RigidNear(far, 2e-3, 0.05));
}

// A person whom no label tells from the room stands elsewhere after a jump: all matches agree, and the room does not.
TEST(Tracker, IsNotFoundByWhatTheDepthImagesContradict) {
  constexpr float kHere_m = 4.2F;
  constexpr float kElsewhere_m = 7;
  Scene scene;
  scene.Start(WithWall(scene.world.Look(Truth(0)), kHere_m));
  for (int frame = 1; frame < 5; ++frame) {
    ASSERT_TRUE(scene.Track(WithWall(scene.world.Look(Truth(frame)), kHere_m)).tracked);
  }
  // Of much of what was just seen nobody asks; of less than half of it, the depth images.
  ASSERT_TRUE(scene.Track(WithWall(scene.world.Look(Truth(5)), kElsewhere_m)).tracked);
  EXPECT_FALSE(scene.Track(WithWall(scene.world.Look(Truth(6), 0, 150), kElsewhere_m)).tracked);
  EXPECT_FALSE(scene.Track(WithWall(scene.world.Look(Truth(7)), kElsewhere_m)).tracked);
  EXPECT_TRUE(scene.Track(WithWall(scene.world.Look(Truth(8)), kHere_m)).tracked);
  EXPECT_TRUE(scene.Track(WithWall(scene.world.Look(Truth(9), 0, 150), kHere_m)).tracked);
}

// Found by few points side by side, a pose may be off by a third of a meter; the step to the next one is no motion.
TEST(Tracker, AFrameFoundElsewhereTellsNoVelocity) {
  Scene scene;
  scene.Start();
  for (int frame = 1; frame < 5; ++frame) {
    ASSERT_TRUE(scene.Track(Truth(frame)).tracked);
  }
  ASSERT_FALSE(scene.Track(PointWorld(kPoints, 99).Look(Truth(0))).tracked);
  const auto view = scene.world.Look(Truth(5));
  const Rigid3 error{ExpSo3({0.13, 0, 0}), {0, 0.3, 0.1}};
  scene.tracker->Relocate({.id = FrameId{5},
                           .timestamp_s = 5 / 30.0,
                           .data = view.data,
                           .reference = KeyframeId{0},
                           .camera_from_reference = error * Truth(5) * Truth(0).Inverse(),
                           .points = std::vector<PointId>(view.data->size())});
  for (int frame = 6; frame < 9; ++frame) {
    const TrackOutcome outcome = scene.Track(Truth(frame));
    ASSERT_TRUE(outcome.tracked) << frame;
    EXPECT_THAT(outcome.camera_from_world, RigidNear(Truth(frame), 2e-3, 0.05)) << frame;
    EXPECT_LT(scene.tracker->Velocity().norm(), 0.5) << frame;  // it is 0.33
  }
}

TEST(Tracker, RecoveryTakesMoreThanTracking) {
  TrackerOptions options;
  options.min_recovery_inliers = 150;
  options.min_inliers = 100;  // static points alone would do for recovery, but none is known to be static
  Scene scene(options);
  scene.Start();
  const PointWorld elsewhere(kPoints, 99);
  ASSERT_TRUE(scene.Track(Truth(1)).tracked);
  ASSERT_TRUE(scene.Track(scene.world.Look(Truth(2), 0, 135)).tracked);
  ASSERT_FALSE(scene.Track(elsewhere.Look(Truth(0))).tracked);
  EXPECT_FALSE(scene.Track(scene.world.Look(Truth(2), 0, 135)).tracked);
  EXPECT_TRUE(scene.Track(Truth(2)).tracked);
}

// The last frame and its keyframe show other points than this frame, but the map holds them, and the motion says where.
TEST(Tracker, TrustsItsPredictionWhereOnlyTheMapKnowsThePoints) {
  constexpr std::uint32_t kSplit = 250;
  Scene scene;
  // Both keyframes share a third part of the points, so that one snapshot holds them.
  scene.Start(kSplit);
  scene.world.AddTo(scene.map, FrameId{1000}, Truth(0), scene.world.Look(Truth(0), kSplit - 100, kPoints));
  scene.Publish();
  for (int frame = 1; frame < 8; ++frame) {
    const TrackOutcome outcome = scene.Track(scene.world.Look(Truth(frame), 0, kSplit - 100));
    ASSERT_TRUE(outcome.tracked);
    ASSERT_EQ(scene.tracker->MakeCandidate().reference, KeyframeId{0});  // that it shares most with
    EXPECT_EQ(outcome.reference, KeyframeId{1});                         // its pose hangs on the newest
  }
  const TrackOutcome outcome = scene.Track(scene.world.Look(Truth(8), kSplit, kPoints));
  ASSERT_TRUE(outcome.tracked);
  EXPECT_THAT(outcome.camera_from_world, RigidNear(Truth(8), 2e-3, 0.05));
  EXPECT_EQ(scene.tracker->MakeCandidate().reference, KeyframeId{1});
}

TEST(Tracker, WantsAKeyframeInTimeAndCountsAnewOnceItIsTaken) {
  TrackerOptions options;
  options.policy.max_frames = 10;
  Scene scene(options);
  scene.Start();
  int frame = 1;
  const auto looks = [&] { return scene.Track(scene.world.Look(Truth(0.1 * frame), 0, 300)); };  // some are gone
  while (!looks().wants_keyframe) {
    ASSERT_LT(++frame, 50);
  }
  EXPECT_GE(frame, options.policy.min_frames);
  EXPECT_LE(frame, options.policy.max_frames + 1);
  const KeyframeCandidate candidate = scene.tracker->MakeCandidate();
  EXPECT_EQ(candidate.reference, KeyframeId{0});
  EXPECT_EQ(candidate.points.size(), candidate.data->size());
  EXPECT_GT(std::ranges::count_if(candidate.points, &PointId::valid), 150);
  EXPECT_FALSE(candidate.uses.empty());
  scene.tracker->KeyframeTaken();
  EXPECT_TRUE(scene.tracker->MakeCandidate().uses.empty());
  EXPECT_FALSE(looks().wants_keyframe);
}

TEST(Tracker, ACandidateMakesNoPointsWhereDynamicOnesAre) {
  Scene scene;
  scene.Start();
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    if (scene.world.IdOf(i).valid()) {
      scene.map.SetMovingProbability(scene.world.IdOf(i), i < 100 ? 0.9 : 0.1);
    }
  }
  const auto view = scene.world.Look(Truth(1));
  ASSERT_TRUE(scene.Track(view).tracked);
  const KeyframeCandidate candidate = scene.tracker->MakeCandidate();
  EXPECT_GT(candidate.blocked.size(), 50U);
  for (const std::uint32_t keypoint : candidate.blocked) {
    EXPECT_LT(view.points[keypoint], 100U);
    EXPECT_FALSE(candidate.points[keypoint].valid());
  }
}

}  // namespace
}  // namespace rds
