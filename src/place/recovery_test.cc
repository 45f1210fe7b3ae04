// SPDX-License-Identifier: Apache-2.0
#include "place/recovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "base/random.h"
#include "testing/matchers.h"
#include "testing/view.h"

namespace rds {
namespace {

constexpr std::uint32_t kPoints = 60;

// A map from one keyframe, whose keypoint 2 i shows point i (odd ones show nothing), and a frame far from it that
// shows point i in keypoint i, everything turned by 90 degrees.
struct Scene {
  ScalePyramid pyramid;
  std::shared_ptr<const LocalMap> map;
  Rigid3 pose{ExpSo3({0.1, -0.2, 1.5}), {0.4, -0.2, 0.3}};
  std::vector<Keypoint> keypoints;  // of the frame
  std::vector<Descriptor> descriptors;

  Scene() {
    Random random(13);
    std::vector<Eigen::Vector3d> points;
    std::vector<Keypoint> first;
    std::vector<Descriptor> looks;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      points.emplace_back(random.Uniform(-0.8, 0.8), random.Uniform(-0.6, 0.6), random.Uniform(2, 4));
      for (int copy = 0; copy < 2; ++copy) {
        first.push_back(See({}, points.back()));
        looks.push_back({random.Bits(), random.Bits(), random.Bits(), random.Bits()});
      }
      keypoints.push_back(See(pose, points.back()));
      keypoints.back().angle_deg = 270;
      descriptors.push_back(looks[looks.size() - 2]);
    }
    Map built(pyramid);
    const auto data = std::make_shared<const FrameData>(TestCamera(), std::move(first), std::move(looks));
    const KeyframeId id = built.AddKeyframe(FrameId{0}, 0, {}, data);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      built.AddPoint(points[i], id, 2 * i);
    }
    map = BuildLocalMap(built, id, {});
  }
  [[nodiscard]] FrameData Current() const { return {TestCamera(), keypoints, descriptors}; }
  // Keypoint i with point i, but for the last `outliers`, which are matched to one another in a circle.
  [[nodiscard]] static std::vector<PointMatch> Matches(std::uint32_t outliers) {
    std::vector<PointMatch> matches;
    const std::uint32_t good = kPoints - outliers;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      matches.push_back({i, i < good ? i : good + (i - good + 7) % outliers, PointState::kUnknown, 1.0});
    }
    return matches;
  }
  [[nodiscard]] std::optional<Rigid3> Ransac(std::span<const PointMatch> matches, int min_inliers = 15) const {
    return RansacPose(Current(), matches, *map, pyramid, min_inliers);
  }
};

TEST(MatchKeyframe, MatchesByAppearanceWhereverTheKeypointsAre) {
  Scene scene;
  const auto matches = MatchKeyframe(scene.map->keyframes[0], scene.Current(), 0.75);
  ASSERT_EQ(matches.size(), kPoints);
  for (const PointMatch& match : matches) {
    EXPECT_EQ(match.point, match.keypoint);
  }
}

TEST(MatchKeyframe, LeavesWhatLooksOrTurnsDifferentlyOrIsAmbiguous) {
  Scene scene;
  scene.keypoints[1].angle_deg = 100;
  for (std::uint64_t& word : scene.descriptors[2]) {
    word ^= 0x1fffU;  // 52 bits in all
  }
  for (std::uint64_t& word : scene.descriptors[3]) {
    word ^= 0xfffU;  // 48 bits
  }
  scene.keypoints.push_back(scene.keypoints[4]);  // two keypoints, nearly alike, neither quite like the point
  scene.descriptors[4][0] ^= 0x1fU;
  scene.descriptors.push_back(scene.descriptors[4]);
  scene.descriptors.back()[1] ^= 1U;
  std::vector<std::uint32_t> missing;
  const auto matches = MatchKeyframe(scene.map->keyframes[0], scene.Current(), 0.75);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    if (std::ranges::find(matches, i, &PointMatch::point) == matches.end()) {
      missing.push_back(i);
    }
  }
  EXPECT_EQ(missing, (std::vector<std::uint32_t>{1, 2, 4}));
}

TEST(RansacPose, FindsThePoseAmongFortyPercentOutliers) {
  const Scene scene;
  const auto pose = scene.Ransac(Scene::Matches(kPoints * 4 / 10));
  ASSERT_TRUE(pose.has_value());
  EXPECT_THAT(*pose, RigidNear(scene.pose, 2e-3, 0.1));
}

TEST(RansacPose, GivesTheSamePoseForTheSameInput) {
  Scene scene;
  Random random(17);
  for (Keypoint& keypoint : scene.keypoints) {  // with noise each triple gives another pose
    keypoint.depth_m *= static_cast<float>(random.Uniform(0.99, 1.01));
  }
  const auto matches = Scene::Matches(20);
  const auto once = scene.Ransac(matches);
  const auto again = scene.Ransac(matches);
  ASSERT_TRUE(once.has_value());
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(once->translation, again->translation);
  EXPECT_EQ(once->rotation.coeffs(), again->rotation.coeffs());
  EXPECT_THAT(*once, RigidNear(scene.pose, 0.05, 1.0));
}

TEST(RansacPose, WantsEnoughMatchesThatAgree) {
  const Scene scene;
  EXPECT_TRUE(scene.Ransac(Scene::Matches(20), 40).has_value());
  EXPECT_FALSE(scene.Ransac(Scene::Matches(20), 41).has_value());
  EXPECT_FALSE(scene.Ransac(Scene::Matches(kPoints)).has_value());
}

TEST(RansacPose, StandsOnDirectionsWhereDepthIsScarce) {
  const auto leave_depth = [](std::uint32_t keypoints) {
    Scene scene;
    for (std::uint32_t i = keypoints; i < kPoints; ++i) {
      scene.keypoints[i].depth_m = 0;
    }
    return scene;
  };
  EXPECT_FALSE(leave_depth(kPoints).Ransac({}, 0).has_value());
  const std::vector<PointMatch> matches = Scene::Matches(20);
  EXPECT_FALSE(leave_depth(0).Ransac(std::span(matches).first(2), 2).has_value());
  for (const std::uint32_t with_depth : {0U, 2U, kPoints / 2 - 1, kPoints / 2}) {
    const auto pose = leave_depth(with_depth).Ransac(matches, static_cast<int>(kPoints - 20));
    ASSERT_TRUE(pose.has_value()) << with_depth;
    EXPECT_THAT(*pose, RigidNear(Scene().pose, 2e-3, 0.1)) << with_depth;
  }
}

// A tracker of the field aborts in its alignment on such input.
TEST(RansacPose, RefusesTriplesThatFixNothing) {
  const auto with_points = [](const std::vector<Eigen::Vector3d>& points) {
    Map map{ScalePyramid()};
    std::vector<Keypoint> keypoints;
    for (const Eigen::Vector3d& point : points) {
      keypoints.push_back(See({}, point.allFinite() ? point : Eigen::Vector3d(0, 0, 2)));
    }
    const auto data = FrameOf(keypoints);
    const KeyframeId id = map.AddKeyframe(FrameId{0}, 0, {}, data);
    std::vector<PointMatch> matches;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      map.AddPoint(points[i], id, i);
      matches.push_back({i, i, PointState::kUnknown, 1.0});
    }
    return RansacPose(*data, matches, *BuildLocalMap(map, id, {}), ScalePyramid(), 3);
  };
  EXPECT_TRUE(with_points({{0, 0, 2}, {0.5, 0, 2}, {0, 0.5, 2}, {0.4, 0.4, 3}}).has_value());
  EXPECT_FALSE(with_points(std::vector<Eigen::Vector3d>(20, {0.1, 0.1, 2})).has_value());  // coincident
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 20; ++i) {
    line.emplace_back(0.02 * i, 0.01 * i, 2 + 0.03 * i);
  }
  EXPECT_FALSE(with_points(line).has_value());
  EXPECT_FALSE(with_points({{0, 0, 2}, {0.5, 0, 2}}).has_value());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(with_points(std::vector<Eigen::Vector3d>(5, {nan, nan, nan})).has_value());
}

TEST(NearestKeyframes, AreSortedByTheDistanceOfTheirCenters) {
  LocalMap map;
  for (const double x : {3.0, 1.0, -2.0, 1.0}) {
    LocalKeyframe keyframe;
    keyframe.id = KeyframeId{static_cast<std::uint32_t>(map.keyframes.size())};
    keyframe.camera_from_world.translation = {-x, 0, 0};  // the center is at x
    map.keyframes.push_back(keyframe);
  }
  const auto ids = [&](int most) {
    std::vector<std::uint32_t> result;
    for (const LocalKeyframe* keyframe : NearestKeyframes(map, {0.5, 0, 0}, most)) {
      result.push_back(keyframe->id.value);
    }
    return result;
  };
  EXPECT_EQ(ids(10), (std::vector<std::uint32_t>{1, 3, 0, 2}));  // the older of equals first; 0 and 2 are equal, too
  EXPECT_EQ(ids(2), (std::vector<std::uint32_t>{1, 3}));
}

}  // namespace
}  // namespace rds
