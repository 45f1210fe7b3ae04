// SPDX-License-Identifier: Apache-2.0
// Creation and fusion of points, as LocalMapper refines a keyframe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "base/random.h"
#include "mapping/local_mapper.h"
#include "testing/matchers.h"
#include "testing/unlocked_map.h"
#include "testing/view.h"

namespace rds {
namespace {

constexpr std::uint32_t kShared = 20;  // points that make the keyframes covisible
constexpr std::uint32_t kNew = 20;     // points of the world that are not in the map yet
constexpr std::uint32_t kAll = kShared + kNew;

// Keyframes that see the same points of the world, in the same order; the first kShared are points of the map already.
struct Scene {
  Map map{ScalePyramid()};
  MappingOptions options;
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;

  Scene() {
    Random random(5);
    for (std::uint32_t i = 0; i < kAll; ++i) {
      points.emplace_back(random.Uniform(-0.8, 0.8), random.Uniform(-0.6, 0.6), random.Uniform(2, 3));
      descriptors.push_back({random.Bits(), random.Bits(), random.Bits(), random.Bits()});
    }
  }
  [[nodiscard]] std::vector<Keypoint> Keypoints(const Rigid3& pose, bool depth) const {
    std::vector<Keypoint> keypoints;
    for (const Eigen::Vector3d& point : points) {
      keypoints.push_back(See(pose, point, depth));
    }
    return keypoints;
  }
  KeyframeId Add(const Rigid3& pose, std::vector<Keypoint> keypoints) {
    const auto count = static_cast<std::uint32_t>(map.keyframes().size());
    const auto data = std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), descriptors);
    const KeyframeId id = map.AddKeyframe(FrameId{count}, count, pose, data);
    for (std::uint32_t i = 0; i < kShared; ++i) {
      if (count == 0) {
        map.AddPoint(points[i], id, i);
      } else {
        EXPECT_TRUE(map.Observe(PointId{i}, id, i));
      }
    }
    map.UpdateCovisibility(id);
    return id;
  }
  KeyframeId Add(const Rigid3& pose, bool depth) { return Add(pose, Keypoints(pose, depth)); }
  void Refine(KeyframeId id) {
    UnlockedMap access(map);
    LocalMapper(options).Refine(access, id);
    EXPECT_THAT(map.Validate(), testing::IsEmpty());
  }
  PointId Point(KeyframeId keyframe, std::uint32_t keypoint) { return map.At(keyframe).points[keypoint]; }
};

const Rigid3 kLeft{};
const Rigid3 kRight{ExpSo3({0.01, 0.1, 0.02}), {-0.4, 0.02, 0.05}};

TEST(Triangulate, MakesThePointsThatBothKeyframesShow) {
  Scene scene;
  const KeyframeId a = scene.Add(kLeft, false);
  const KeyframeId b = scene.Add(kRight, false);
  scene.Refine(b);
  EXPECT_EQ(scene.map.point_count(), kAll);
  for (std::uint32_t i = kShared; i < kAll; ++i) {
    ASSERT_TRUE(scene.Point(b, i).valid()) << i;
    EXPECT_EQ(scene.Point(a, i), scene.Point(b, i));
    const MapPoint& point = scene.map.At(scene.Point(b, i));
    EXPECT_THAT(point.position, MatrixNear(scene.points[i], 1e-3));
    EXPECT_EQ(point.observations.size(), 2U);
    EXPECT_EQ(point.reference, a);  // the oldest observation hosts it
    EXPECT_EQ(point.created_at, b);
  }
  EXPECT_EQ(scene.map.At(b).covisible.at(0).shared_points, static_cast<int>(kAll));
}

TEST(Triangulate, WhatIsOffTheEpipolarLineMakesNoPoint) {
  Scene scene;
  const KeyframeId a = scene.Add(kLeft, false);
  std::vector<Keypoint> keypoints = scene.Keypoints(kRight, false);
  keypoints[kShared].y += 10;  // the baseline lies along x, and so do the lines, nearly
  const KeyframeId b = scene.Add(kRight, keypoints);
  scene.Refine(b);
  EXPECT_FALSE(scene.Point(a, kShared).valid());
  EXPECT_FALSE(scene.Point(b, kShared).valid());
  EXPECT_EQ(scene.map.point_count(), kAll - 1);
}

TEST(Triangulate, ALookAlikeOffTheEpipolarLineIsNoRival) {
  Scene scene;
  scene.Add(kLeft, false);
  scene.descriptors[kShared + 1] = scene.descriptors[kShared];
  scene.descriptors[kShared][0] ^= 0xffU;  // the right keypoint looks less like it than the wrong one
  const KeyframeId b = scene.Add(kRight, false);
  scene.Refine(b);
  ASSERT_TRUE(scene.Point(b, kShared).valid());
  EXPECT_THAT(scene.map.At(scene.Point(b, kShared)).position, MatrixNear(scene.points[kShared], 1e-3));
  EXPECT_FALSE(scene.Point(b, kShared + 1).valid());
}

TEST(Triangulate, NeedsABaseline) {
  Scene scene;
  scene.Add(kLeft, true);
  scene.Refine(scene.Add({Eigen::Quaterniond::Identity(), {0.079, 0, 0}}, true));
  EXPECT_EQ(scene.map.point_count(), kShared);
  Scene wider;
  wider.Add(kLeft, true);
  wider.Refine(wider.Add({Eigen::Quaterniond::Identity(), {0.081, 0, 0}}, true));
  EXPECT_EQ(wider.map.point_count(), kAll);
}

TEST(Triangulate, LabelsKeepPeopleOutAndSpeakForTheRest) {
  Scene scene;
  const KeyframeId a = scene.Add(kLeft, false);
  const KeyframeId b = scene.Add(kRight, false);
  std::vector<KeypointLabel> labels(kAll, KeypointLabel::kStatic);
  labels[kShared] = KeypointLabel::kDynamic;
  scene.map.Label(a, labels);
  scene.Refine(b);
  EXPECT_EQ(scene.map.point_count(), kAll - 1);
  EXPECT_FALSE(scene.Point(b, kShared).valid());
  EXPECT_NEAR(scene.map.probabilities().Get(scene.Point(b, kShared + 1)), 0.1, 1e-6);
}

// Two keyframes with depth; each has points of its own for what is not shared, slightly apart.
struct Duplicates : Scene {
  KeyframeId a;
  KeyframeId b;

  Duplicates() {
    a = Add(kLeft, true);
    b = Add(kRight, true);
  }
  PointId Own(KeyframeId keyframe, std::uint32_t keypoint, double off_m = 0.001) {
    return map.AddPoint(points[keypoint] + Eigen::Vector3d(off_m, 0, 0), keyframe, keypoint);
  }
};

TEST(Fuse, MergesDuplicatesAndWhatTheyKnow) {
  Duplicates scene;
  for (std::uint32_t i = kShared; i < kAll; ++i) {
    scene.map.SetMovingProbability(scene.Own(scene.a, i), 0.3);
    scene.map.SetMovingProbability(scene.Own(scene.b, i), 0.2);
  }
  const PointId first = scene.Point(scene.a, kShared);
  const PointId second = scene.Point(scene.b, kShared);
  scene.Refine(scene.b);
  EXPECT_EQ(scene.map.point_count(), kAll);
  for (std::uint32_t i = kShared; i < kAll; ++i) {
    EXPECT_EQ(scene.Point(scene.a, i), scene.Point(scene.b, i));
    EXPECT_EQ(scene.map.At(scene.Point(scene.a, i)).observations.size(), 2U);
    EXPECT_NEAR(scene.map.probabilities().Get(scene.Point(scene.a, i)), 0.06 / (0.06 + 0.56), 1e-6);
  }
  EXPECT_EQ(scene.map.Resolve(first), scene.map.Resolve(second));
  EXPECT_EQ(scene.map.At(scene.b).covisible.at(0).shared_points, static_cast<int>(kAll));
}

TEST(Fuse, ThePointThatMoreKeyframesSeeStays) {
  Duplicates scene;
  const KeyframeId c = scene.Add({Eigen::Quaterniond::Identity(), {-0.2, 0, 0}}, true);
  const PointId seen_once = scene.Own(scene.a, kShared);
  const PointId seen_twice = scene.Own(scene.b, kShared);
  ASSERT_TRUE(scene.map.Observe(seen_twice, c, kShared));
  scene.Refine(scene.b);
  EXPECT_EQ(scene.map.Find(seen_once), nullptr);
  EXPECT_EQ(scene.map.Resolve(seen_once), seen_twice);
  EXPECT_EQ(scene.map.At(seen_twice).observations.size(), 3U);
}

TEST(Fuse, FreeKeypointsGetThePointsOfNeighbors) {
  Duplicates scene;
  const PointId theirs = scene.Own(scene.a, kShared);
  const PointId ours = scene.Own(scene.b, kShared + 1);
  std::vector<KeypointLabel> labels(kAll, KeypointLabel::kDynamic);
  scene.map.Label(scene.b, labels);
  scene.Refine(scene.b);
  EXPECT_EQ(scene.Point(scene.b, kShared), theirs);
  EXPECT_EQ(scene.Point(scene.a, kShared + 1), ours);
  EXPECT_NEAR(scene.map.probabilities().Get(theirs), 0.9, 1e-6);  // the new observation's label counts
}

TEST(Fuse, KeepsApartWhatDiffersInDepthOrAppearance) {
  Scene scene;
  scene.options.triangulate_neighbors = 0;
  const KeyframeId a = scene.Add(kLeft, true);
  std::vector<Keypoint> keypoints = scene.Keypoints(kRight, true);
  const Eigen::Vector3d before = kRight.Inverse() * (0.8 * (kRight * scene.points[kShared]));  // in the same pixel
  keypoints[kShared] = See(kRight, before, true);
  for (std::uint64_t& word : scene.descriptors[kShared + 1]) {
    word = ~word;  // the other keyframe sees it otherwise
  }
  const KeyframeId b = scene.Add(kRight, keypoints);
  const PointId behind = scene.map.AddPoint(scene.points[kShared], a, kShared);
  const PointId front = scene.map.AddPoint(before, b, kShared);
  const PointId one = scene.map.AddPoint(scene.points[kShared + 1], a, kShared + 1);
  const PointId other = scene.map.AddPoint(scene.points[kShared + 1], b, kShared + 1);
  scene.Refine(b);
  EXPECT_EQ(scene.Point(a, kShared), behind);
  EXPECT_EQ(scene.Point(b, kShared), front);
  EXPECT_EQ(scene.Point(a, kShared + 1), one);
  EXPECT_EQ(scene.Point(b, kShared + 1), other);
}

}  // namespace
}  // namespace rds
