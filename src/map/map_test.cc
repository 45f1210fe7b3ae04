// SPDX-License-Identifier: Apache-2.0
#include "map/map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "base/error.h"
#include "map/local_map.h"

namespace rds {
namespace {

using testing::IsEmpty;

std::shared_ptr<const FrameData> Data(std::size_t keypoints) {
  PinholeCamera camera;
  camera.fx = camera.fy = 500;
  camera.cx = 320;
  camera.cy = 240;
  std::vector<Keypoint> list(keypoints);
  std::vector<Descriptor> descriptors(keypoints);
  for (std::size_t i = 0; i < keypoints; ++i) {
    list[i].x = list[i].raw_x = static_cast<float>(10 + i % 60 * 10);
    list[i].y = list[i].raw_y = static_cast<float>(10 + i / 60 * 10);
    list[i].depth_m = 2;
    descriptors[i] = {i, i * i, ~i, i << 20U};
  }
  return std::make_shared<const FrameData>(camera, std::move(list), std::move(descriptors));
}

KeyframeId AddKeyframe(Map& map, std::uint32_t frame, double x = 0) {
  return map.AddKeyframe(FrameId{frame}, frame, {Eigen::Quaterniond::Identity(), {-x, 0, 0}}, Data(100));
}

// Two keyframes that share `shared` points.
struct Pair {
  Map map{ScalePyramid()};
  KeyframeId a;
  KeyframeId b;
  explicit Pair(std::uint32_t shared) {
    a = AddKeyframe(map, 0);
    b = AddKeyframe(map, 5, 0.1);
    for (std::uint32_t i = 0; i < shared; ++i) {
      const PointId point = map.AddPoint({0.01 * i, 0, 2}, a, i);
      EXPECT_TRUE(map.Observe(point, b, i));
    }
    map.UpdateCovisibility(b);
  }
};

TEST(Map, LinksBothSides) {
  Pair pair(20);
  EXPECT_EQ(pair.map.point_count(), 20U);
  const MapPoint& point = pair.map.At(PointId{3});
  ASSERT_EQ(point.observations.size(), 2U);
  EXPECT_EQ(pair.map.At(pair.b).points[3], PointId{3});
  EXPECT_FALSE(pair.map.Observe(PointId{3}, pair.b, 50));  // seen there already
  EXPECT_FALSE(pair.map.Observe(PointId{3}, pair.b, 4));   // taken
}

TEST(Map, RemovingTheLastObservationErasesThePoint) {
  Pair pair(20);
  pair.map.Forget(PointId{3}, pair.a);
  EXPECT_EQ(pair.map.At(PointId{3}).reference, pair.b);
  pair.map.Forget(PointId{3}, pair.b);
  EXPECT_EQ(pair.map.Find(PointId{3}), nullptr);
  EXPECT_FALSE(pair.map.At(pair.b).points[3].valid());
  EXPECT_EQ(pair.map.point_count(), 19U);
  EXPECT_THROW(static_cast<void>(pair.map.At(PointId{3})), InvariantError);
}

TEST(Map, CovisibilityCountsSharedPointsAndTheTreeHasOneRoot) {
  Pair pair(20);
  ASSERT_EQ(pair.map.At(pair.a).covisible.size(), 1U);
  EXPECT_EQ(pair.map.At(pair.a).covisible[0].keyframe, pair.b);
  EXPECT_EQ(pair.map.At(pair.a).covisible[0].shared_points, 20);
  EXPECT_EQ(pair.map.At(pair.b).parent, pair.a);
  EXPECT_FALSE(pair.map.At(pair.a).parent.valid());
  EXPECT_THROW(pair.map.EraseKeyframe(pair.a), InvariantError);
}

TEST(Map, AWeakEdgeIsKeptOnlyAsTheBestOne) {
  Pair pair(Map::kMinShared - 1);
  EXPECT_EQ(pair.map.At(pair.b).covisible.size(), 1U);
  const KeyframeId c = AddKeyframe(pair.map, 9);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(pair.map.Observe(PointId{i}, c, i));
  }
  for (std::uint32_t i = 20; i < 40; ++i) {
    const PointId point = pair.map.AddPoint({0.01 * i, 0, 2}, pair.a, i);
    EXPECT_TRUE(pair.map.Observe(point, c, i));
  }
  pair.map.UpdateCovisibility(c);
  ASSERT_EQ(pair.map.At(c).covisible.size(), 1U);
  EXPECT_EQ(pair.map.At(c).covisible[0].keyframe, pair.a);
}

TEST(Map, FusedPointsResolveToTheSurvivor) {
  Pair pair(20);
  const PointId extra = pair.map.AddPoint({0.5, 0, 2}, pair.a, 60);
  const PointId other = pair.map.AddPoint({0.5, 0, 2}, pair.b, 60);
  const PointId last = pair.map.AddPoint({0.5, 0, 2}, pair.b, 61);
  pair.map.Fuse(extra, other);
  EXPECT_EQ(pair.map.Resolve(extra), other);
  EXPECT_EQ(pair.map.At(other).observations.size(), 2U);
  EXPECT_EQ(pair.map.At(pair.a).points[60], other);
  pair.map.Fuse(other, last);
  EXPECT_EQ(pair.map.Resolve(extra), last);
  EXPECT_EQ(pair.map.RecentReplacements().size(), 2U);
  pair.map.ErasePoint(last);
  EXPECT_FALSE(pair.map.Resolve(extra).valid());
}

// As in a long run: keyframes come and go, and with them their points, many times as many as the table has ids.
TEST(Map, IdsOfPointsOutliveTheirTable) {
  constexpr std::size_t kPages = 16;
  Map map(ScalePyramid(), {}, kPages);
  const KeyframeId root = AddKeyframe(map, 0);
  const PointId first = map.AddPoint({0, 0, 2}, root, 0);
  PointId newest = first;
  std::size_t given = 1;
  for (std::uint32_t frame = 1; given < 20 * kPages * kIdsPerPage; ++frame) {
    const KeyframeId keyframe = AddKeyframe(map, frame);
    map.Observe(first, keyframe, 0);
    map.UpdateCovisibility(keyframe);
    PointId fused;
    for (std::uint32_t i = 1; i < 100; ++i, ++given) {
      const PointId point = map.AddPoint({0.01 * i, 0, 2}, keyframe, i);
      ASSERT_GT(point, newest);
      newest = point;
      if (i == 50) {
        fused = point;
      }
    }
    map.Fuse(fused, newest);
    ASSERT_EQ(map.Resolve(fused), newest);
    map.EraseKeyframe(keyframe);
    ASSERT_FALSE(map.Resolve(newest).valid());
    map.SetMovingProbability(first, 0.25);
  }
  EXPECT_GT(newest.index(), 20 * kPages * kIdsPerPage);
  EXPECT_EQ(map.point_count(), 1U);
  EXPECT_EQ(map.Points(), std::vector<PointId>{first});
  EXPECT_LE(map.probabilities().pages_made(), kPages);
  EXPECT_EQ(map.probabilities().Get(first), 0.25);
  EXPECT_THAT(map.Validate(), IsEmpty());
}

TEST(Map, AnErasedKeyframeHangsOnItsParent) {
  Pair pair(20);
  const KeyframeId c = AddKeyframe(pair.map, 9, 0.3);
  for (std::uint32_t i = 0; i < 20; ++i) {
    EXPECT_TRUE(pair.map.Observe(PointId{i}, c, i));
  }
  pair.map.UpdateCovisibility(c);
  const Rigid3 before = pair.map.CameraFromWorld(pair.b);
  pair.map.EraseKeyframe(pair.b);
  EXPECT_EQ(pair.map.keyframes(), (std::vector<KeyframeId>{pair.a, c}));
  EXPECT_EQ(pair.map.At(c).parent, pair.a);
  EXPECT_TRUE(pair.map.CameraFromWorld(pair.b).translation.isApprox(before.translation));
  // A correction of the parent reaches what hangs on it.
  pair.map.SetPose(pair.a, {Eigen::Quaterniond::Identity(), {0, 1, 0}});
  EXPECT_TRUE(pair.map.CameraFromWorld(pair.b).translation.isApprox(before.translation + Eigen::Vector3d(0, 1, 0)));
  EXPECT_EQ(pair.map.At(PointId{3}).observations.size(), 2U);
}

TEST(LocalMap, IsASortedCopyThatLaterChangesDoNotReach) {
  Pair pair(20);
  const PointId gone = pair.map.AddPoint({0.5, 0, 2}, pair.a, 60);
  const PointId there = pair.map.AddPoint({0.5, 0, 2}, pair.b, 60);
  pair.map.Fuse(gone, there);
  const auto local = BuildLocalMap(pair.map, pair.b, {});
  EXPECT_EQ(local->size(), 21U);
  EXPECT_TRUE(std::ranges::is_sorted(local->ids));
  ASSERT_EQ(local->keyframes.size(), 2U);
  EXPECT_EQ(local->keyframes[0].links.size(), 21U);
  EXPECT_EQ(local->IndexOf(gone), local->IndexOf(there));
  EXPECT_EQ(local->IndexOf(PointId{999}), std::nullopt);
  EXPECT_EQ(local->Find(KeyframeId{7}), nullptr);
  const Eigen::Vector3d before = local->Position(0);
  pair.map.Move(PointId{0}, before.cast<double>() + Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(local->Position(0), before);
}

TEST(LocalMap, IsBounded) {
  Pair pair(20);
  for (std::uint32_t k = 0; k < 20; ++k) {
    const KeyframeId id = AddKeyframe(pair.map, 10 + k);
    for (std::uint32_t i = 0; i < 20; ++i) {
      EXPECT_TRUE(pair.map.Observe(PointId{i}, id, i));
    }
    pair.map.UpdateCovisibility(id);
  }
  LocalMapOptions options;
  options.keyframes = 5;
  EXPECT_EQ(BuildLocalMap(pair.map, pair.map.newest(), options)->keyframes.size(), 5U);
}

TEST(LocalMap, MostSharedIsTheKeyframeThatSeesMostOfThePointsTheNewestOfEquals) {
  LocalMap local;
  for (std::uint32_t k = 0; k < 3; ++k) {
    local.keyframes.push_back({KeyframeId{k}, FrameId{k}, {}, nullptr, {}});
  }
  local.keyframes[0].links = {{0, 0}, {1, 1}, {2, 2}};
  local.keyframes[1].links = {{0, 1}, {1, 3}};
  local.keyframes[2].links = {{0, 4}};
  local.ids.resize(5);
  local.CollectViews();
  EXPECT_EQ(local.MostShared(std::vector<std::uint32_t>{0, 1, 2, 3, 4}).id, KeyframeId{0});
  EXPECT_EQ(local.MostShared(std::vector<std::uint32_t>{0, 1, 3}).id, KeyframeId{1});
  EXPECT_EQ(local.MostShared(std::vector<std::uint32_t>{}).id, KeyframeId{2});
}

}  // namespace
}  // namespace rds
