// SPDX-License-Identifier: Apache-2.0
#include "loop/loop_closer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "map/map_bundle.h"
#include "testing/matchers.h"
#include "testing/ring_world.h"
#include "testing/unlocked_map.h"

namespace rds {
namespace {

using testing::AnyOf;
using testing::IsEmpty;

struct Scene {
  explicit Scene(const RingOptions& ring, const LoopOptions& options = {})
      : world(ring), closer(options, ScalePyramid(), {}, false) {}

  // Tells the closer of keyframes one by one, and keeps what came of it.
  void Learn(const std::vector<KeyframeId>& ids) {
    for (const KeyframeId id : ids) {
      closer.Index(access, id);
      if (const auto closure = closer.Close(access, id)) {
        closures.push_back(*closure);
        EXPECT_THAT(map.Validate(), IsEmpty());
      }
    }
  }
  [[nodiscard]] std::vector<Closure> Moved() const {
    std::vector<Closure> moved;
    std::ranges::copy_if(closures, std::back_inserter(moved), &Closure::moved);
    return moved;
  }
  // Of the keyframes that were recognized as one place: the largest distance from what is true.
  [[nodiscard]] double WorstPlace() const {
    double worst = 0;
    for (const Closure& closure : closures) {
      worst = std::max(worst, world.RelativeError(map, closure.keyframe, closure.place));
    }
    return worst;
  }

  RingWorld world;
  Map map{ScalePyramid()};
  UnlockedMap access{map};
  LoopCloser closer;
  std::vector<Closure> closures;
};

// rtabmap #418, rtabmap_ros #280: right loops refused as covariances are too small.
TEST(LoopCloser, ClosesARingWhateverItsDrift) {
  for (const double turn_rad : {0.0005, 0.001, 0.002}) {  // from one keyframe to the next
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      Scene scene({.seed = seed, .turn_rad = turn_rad});
      const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 160);
      const double before = scene.world.Rmse(scene.map, ids);
      scene.Learn(ids);
      ASSERT_FALSE(scene.Moved().empty()) << turn_rad;
      EXPECT_FALSE(scene.Moved()[0].merged.valid());
      EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.25 * before) << turn_rad << " " << before;
      EXPECT_LT(scene.WorstPlace(), 0.1);
    }
  }
}

// Two and a half kilometers.
TEST(LoopCloser, ARoundOfTenThousandKeyframesIsClosedAndAdjusted) {
  Scene scene(
      {.radius_m = 400, .keyframes = 10'000, .rounds = 1.006, .landmarks_per_m = 40, .drift = 0.001, .turn_rad = 1e-5});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 10'000);
  const double before = scene.world.Rmse(scene.map, ids);
  int loops = 0;
  for (const KeyframeId id : ids) {
    scene.closer.Index(scene.access, id);
    loops += id > ids[9900] && scene.closer.Close(scene.access, id) ? 1 : 0;
  }
  EXPECT_GE(loops, 1);
  EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.1 * before);
  EXPECT_TRUE(scene.closer.Adjust(scene.access, scene.map.WorldOf(ids.front()), {}));
  EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.1 * before);
  EXPECT_THAT(scene.map.Validate(), IsEmpty());
}

TEST(LoopCloser, APlaceThatIsTiedByPointsIsNotFoundAgain) {
  Scene scene({.turn_rad = 0.001});
  scene.Learn(scene.world.AddTo(scene.map, 0, 160));
  ASSERT_FALSE(scene.closures.empty());
  for (const Closure& closure : scene.closures) {
    const auto again = scene.closer.Close(scene.access, closure.keyframe);
    EXPECT_FALSE(again && again->place == closure.place) << closure.keyframe.value;
  }
}

// A few points that both ends of a revisit see, of a relocalization that was a little off, say, do not fix it.
TEST(LoopCloser, APlaceIsFoundAgainBesideOneThatIsTiedByAFewPoints) {
  Scene scene({.turn_rad = 0.001});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 160);
  for (const KeyframeId id : ids) {
    scene.closer.Index(scene.access, id);
  }
  constexpr std::size_t kTied = 14;  // the last one was taken beside it
  Correction correction;
  for (std::uint32_t k = 0; correction.matches.size() < 6; ++k) {
    const PointId point = scene.map.At(ids[kTied]).points[k];
    if (point.valid()) {
      correction.matches.push_back({point, {ids.back(), scene.map.At(ids.back()).pose_revision}, k});
    }
  }
  scene.map.Apply(correction);
  scene.map.UpdateCovisibility(ids.back());
  const auto closure = scene.closer.Close(scene.access, ids.back());
  ASSERT_TRUE(closure.has_value());
  EXPECT_THAT(closure->place, AnyOf(ids[kTied - 2], ids[kTied - 1], ids[kTied + 1], ids[kTied + 2]));
}

TEST(LoopCloser, WithoutARevisitThereIsNoLoop) {
  Scene scene({.keyframes = 130, .rounds = 0.9, .turn_rad = 0.002});
  scene.Learn(scene.world.AddTo(scene.map, 0, 130));
  EXPECT_THAT(scene.closures, IsEmpty());
}

// ORB_SLAM3 #533, #887: a short revisit at the end of a recording.
TEST(LoopCloser, TwoKeyframesOfARevisitAreEnough) {
  Scene scene({.keyframes = 148, .rounds = 1.015, .turn_rad = 0.002});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 148);
  const double before = scene.world.Rmse(scene.map, ids);
  scene.Learn(ids);
  EXPECT_FALSE(scene.Moved().empty());
  EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.3 * before);
}

// rtabmap #1089, rtabmap_ros #1265: places that are alike in all that is seen of them.
TEST(LoopCloser, ARingOfEqualPartsIsNotFolded) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Scene scene({.seed = seed, .keyframes = 136, .rounds = 0.95, .turn_rad = 0.001, .period = 4});
    const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 136);
    const double before = scene.world.Rmse(scene.map, ids);
    scene.Learn(ids);
    EXPECT_THAT(scene.closures, IsEmpty()) << seed;
    EXPECT_LE(scene.world.Rmse(scene.map, ids), before * 1.0001) << seed;
  }
}

// Places that are alike, the next of which is 8 m on: their map would bend so far, but none drifts so far on the way.
TEST(LoopCloser, ACorrectionThatTheWayDoesNotExplainIsNoLoop) {
  Scene alike({.radius_m = 16, .keyframes = 290, .rounds = 0.95, .landmarks_per_m = 200, .period = 12});
  const std::vector<KeyframeId> ids = alike.world.AddTo(alike.map, 0, 290);
  alike.Learn(ids);
  EXPECT_THAT(alike.closures, IsEmpty());
  EXPECT_LT(alike.world.Rmse(alike.map, ids), 1e-6);

  Scene turned({.turn_rad = 0.004});  // by 37 degrees on 55 m
  turned.Learn(turned.world.AddTo(turned.map, 0, 160));
  EXPECT_THAT(turned.closures, IsEmpty());
}

// What moves unrecognized may bend a map by far more than tracking drifts.
TEST(LoopCloser, AMapThatIsBentOnAShortWayIsMended) {
  Scene scene({.radius_m = 4, .keyframes = 80, .turn_rad = 0.005});  // by 21 degrees on 25 m
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 80);
  const double before = scene.world.Rmse(scene.map, ids);
  scene.Learn(ids);
  ASSERT_FALSE(scene.Moved().empty());
  EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.5 * before) << before;
  EXPECT_LT(scene.WorstPlace(), 0.1);
}

// ORB_SLAM3 PR #416, #242: maps that overlap and never become one.
TEST(LoopCloser, PiecesBecomeOneWorld) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scene scene({.seed = seed, .keyframes = 80, .rounds = 0.5});
    std::vector<KeyframeId> all;
    for (const auto& [first, last] : std::vector<std::pair<int, int>>{{50, 80}, {0, 24}, {20, 54}}) {
      const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, first, last);
      scene.Learn(ids);
      all.insert(all.end(), ids.begin(), ids.end());
    }
    for (const KeyframeId id : all) {
      EXPECT_EQ(scene.map.WorldOf(id), scene.map.WorldOf(all.front())) << seed;
    }
    ASSERT_EQ(std::ranges::count_if(scene.closures, [](const Closure& c) { return c.merged.valid(); }), 2);
    EXPECT_LT(scene.world.Rmse(scene.map, all), 0.1) << seed;
    EXPECT_LT(scene.WorstPlace(), 0.06) << seed;
  }
}

TEST(LoopCloser, TheLargerWorldKeepsItsPlaceUnlessToldOtherwise) {
  for (const KeptWorld keep : {KeptWorld::kLarger, KeptWorld::kCurrent}) {
    LoopOptions options;
    options.keep = keep;
    Scene scene({.keyframes = 80, .rounds = 0.5}, options);
    const std::vector<KeyframeId> large = scene.world.AddTo(scene.map, 0, 50);
    scene.Learn(large);
    const std::vector<KeyframeId> small = scene.world.AddTo(scene.map, 40, 56);
    const Rigid3 large_before = scene.map.CameraFromWorld(large.front());
    const Rigid3 small_before = scene.map.CameraFromWorld(small.front());
    scene.Learn(small);
    ASSERT_FALSE(scene.closures.empty());
    const Closure& merge = scene.closures.front();
    ASSERT_TRUE(merge.merged.valid());
    const bool large_stays = keep == KeptWorld::kLarger;
    EXPECT_EQ((scene.map.CameraFromWorld(large.front()).translation - large_before.translation).norm() < 1e-9,
              large_stays);
    EXPECT_EQ((scene.map.CameraFromWorld(small.front()).translation - small_before.translation).norm() < 1e-9,
              !large_stays);
    // What is said of the merge is where the other world is now.
    const KeyframeId moved = large_stays ? small.front() : large.front();
    const Rigid3 before = large_stays ? small_before : large_before;
    EXPECT_THAT(scene.map.CameraFromWorld(moved), RigidNear(before * merge.into_from_from.Inverse(), 0.05, 0.5));
  }
}

TEST(LoopCloser, AFirstKeyframeAloneIsNotMerged) {
  Scene scene({.keyframes = 60, .rounds = 0.4});
  scene.Learn(scene.world.AddTo(scene.map, 0, 50));
  scene.Learn(scene.world.AddTo(scene.map, 20, 21));
  EXPECT_THAT(scene.closures, IsEmpty());
}

TEST(LoopCloser, FindsALostFrameInAnyWorld) {
  Scene scene({.keyframes = 120, .rounds = 0.8});
  const std::vector<KeyframeId> one = scene.world.AddTo(scene.map, 0, 40);
  const std::vector<KeyframeId> other = scene.world.AddTo(scene.map, 70, 110);
  scene.Learn(one);
  scene.Learn(other);
  ASSERT_THAT(scene.closures, IsEmpty());
  for (const int at : {20, 90}) {
    const auto found = scene.closer.Relocalize(
        scene.access, {scene.world.Look(scene.world.truth[static_cast<std::size_t>(at)], 3).data, {}}, 0);
    ASSERT_TRUE(found.has_value()) << at;
    EXPECT_EQ(found->world, scene.map.WorldOf(at == 20 ? one.front() : other.front()));
    EXPECT_EQ(found->map->world, found->world);
  }
  EXPECT_FALSE(scene.closer.Relocalize(scene.access, {scene.world.Look(scene.world.PoseAt(5.4), 3).data, {}}, 0));
}

// What few matches say of one frame may be wrong; of two frames in a row the same is not.
TEST(LoopCloser, AFrameOfWhichLittleIsKnownIsFoundOnceAnotherAgrees) {
  Scene scene({.keyframes = 60, .rounds = 0.4, .landmarks_per_m = 32});
  scene.Learn(scene.world.AddTo(scene.map, 0, 60));
  const auto relocalize = [&](int at, std::uint64_t noise, double timestamp_s) {
    return scene.closer.Relocalize(
        scene.access, {scene.world.Look(scene.world.truth[static_cast<std::size_t>(at)], noise).data, {}}, timestamp_s);
  };
  EXPECT_FALSE(relocalize(20, 3, 1.0));
  EXPECT_FALSE(relocalize(40, 4, 1.1)) << "elsewhere";
  const auto found = relocalize(40, 5, 1.2);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(std::ssize(found->matches), kRelocalizationBounds.matches);
  EXPECT_FALSE(relocalize(40, 6, 1.3)) << "each is asked for once";
  EXPECT_FALSE(relocalize(40, 7, 3.0)) << "long after";
}

TEST(LoopCloser, ErasedKeyframesLeaveTheIndex) {
  Scene scene({.keyframes = 60, .rounds = 0.4});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 60);
  scene.Learn(ids);
  for (std::size_t i = 1; i < ids.size(); i += 2) {
    scene.map.EraseKeyframe(ids[i]);
  }
  for (int again = 0; again < 100; ++again) {
    scene.closer.Index(scene.access, ids[0]);
  }
  EXPECT_EQ(scene.closer.index().size(), scene.map.keyframes().size());
}

TEST(LoopCloser, FullBundleAdjustmentMakesAMapBetter) {
  Scene scene({.keyframes = 60, .rounds = 0.4, .drift = 0.01, .turn_rad = 0.002});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 60);
  const double before = scene.world.Rmse(scene.map, ids);
  const std::uint32_t epoch = scene.map.epoch();
  ASSERT_TRUE(scene.closer.Adjust(scene.access, scene.map.WorldOf(ids[0]), {}));
  EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.5 * before);
  EXPECT_EQ(scene.map.epoch(), epoch + 1);
  EXPECT_THAT(scene.map.Validate(), IsEmpty());
}

// A map of one place has about as many edges as pairs of keyframes.
TEST(LoopCloser, OfALargeMapOfOnePlaceEveryOtherKeyframeIsAdjustedAndTheRestFollow) {
  Scene scene({.keyframes = 60, .rounds = 0.1, .drift = 0.01, .turn_rad = 0.002});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 60);
  const WorldId world = scene.map.WorldOf(ids[0]);
  EXPECT_EQ(KeyframesToAdjust(scene.map, world, 60 * 60).size(), 60U);
  const std::vector<KeyframeId> some = KeyframesToAdjust(scene.map, world, 60 * 59 / 4);
  EXPECT_EQ(some.size(), 30U);
  EXPECT_EQ(some.front(), ids.front());
  const double before = scene.world.Rmse(scene.map, ids);
  const auto bundle = PlanBundle(scene.map, some, {}, PointsToAdjust(scene.map, some, false), false);
  ASSERT_TRUE(bundle);
  BendTo(scene.map, *bundle, AdjustBundle(bundle->problem, {}));
  EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.6 * before);
  EXPECT_THAT(scene.map.Validate(), IsEmpty());
}

TEST(LoopCloser, FullBundleAdjustmentThatIsStoppedOrOvertakenChangesNothing) {
  Scene scene({.keyframes = 40, .rounds = 0.3, .turn_rad = 0.002});
  const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 40);
  const Rigid3 before = scene.map.CameraFromWorld(ids.back());
  EXPECT_FALSE(scene.closer.Adjust(scene.access, scene.map.WorldOf(ids[0]), [] { return true; }));
  int polled = 0;
  EXPECT_FALSE(scene.closer.Adjust(scene.access, scene.map.WorldOf(ids[0]), [&] {
    if (polled++ == 0) {  // a loop is closed meanwhile
      scene.map.Bend(std::vector<Map::WorldMove>{{ids[0], {}}});
    }
    return false;
  }));
  EXPECT_THAT(scene.map.CameraFromWorld(ids.back()), RigidNear(before, 1e-9, 1e-6));
}

}  // namespace
}  // namespace rds
