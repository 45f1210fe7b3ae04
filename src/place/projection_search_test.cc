// SPDX-License-Identifier: Apache-2.0
#include "place/projection_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "testing/view.h"

namespace rds {
namespace {

constexpr std::uint32_t kPoints = 30;
constexpr double kWindowPx = 8;

// A map made from one keyframe at the origin, keypoint i showing point i, and a current frame a little aside whose
// keypoints come in the opposite order. Tests change the keypoints and descriptors of the current frame.
struct Scene {
  ScalePyramid pyramid;
  std::shared_ptr<const FrameData> last;
  std::shared_ptr<const LocalMap> map;
  Rigid3 pose{ExpSo3({0.01, -0.03, 0}), {0.05, 0, 0.02}};
  std::vector<Keypoint> keypoints;  // of the current frame
  std::vector<Descriptor> descriptors;
  std::vector<std::uint8_t> taken = std::vector<std::uint8_t>(kPoints, 0);
  std::vector<std::uint8_t> occupied = std::vector<std::uint8_t>(kPoints, 0);

  Scene() {
    Random random(11);
    std::vector<Eigen::Vector3d> points;
    std::vector<Keypoint> first;
    for (std::uint32_t i = 0; i < kPoints; ++i) {  // 80 px apart at least
      points.push_back(TestCamera().Unproject({80.0 + 90 * (i % 6), 60.0 + 80 * (i / 6)}, random.Uniform(2, 3)));
      first.push_back(See({}, points.back()));
      keypoints.push_back(See(pose, points.back()));
      descriptors.push_back({random.Bits(), random.Bits(), random.Bits(), random.Bits()});
    }
    last = std::make_shared<const FrameData>(TestCamera(), std::move(first), descriptors);
    std::ranges::reverse(keypoints);
    Map built(pyramid);
    const KeyframeId id = built.AddKeyframe(FrameId{0}, 0, {}, last);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      built.AddPoint(points[i], id, i);
    }
    map = BuildLocalMap(built, id, {});
    std::ranges::reverse(descriptors);
  }
  static std::uint32_t KeypointOf(std::uint32_t point) { return kPoints - 1 - point; }
  Keypoint& Shows(std::uint32_t point) { return keypoints[KeypointOf(point)]; }
  [[nodiscard]] FrameData Current() const { return {TestCamera(), keypoints, descriptors}; }
  [[nodiscard]] std::vector<PointMatch> SearchLast(const Rigid3& guess) const {
    std::vector<LastObservation> observations;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      observations.push_back({i, i});
    }
    return SearchLastFrame(*last, observations, Current(), guess, *map, pyramid, kWindowPx);
  }
  [[nodiscard]] LocalSearch SearchMap(const Rigid3& guess) const {
    return SearchLocalMap(Current(), guess, *map, pyramid, taken, occupied, kWindowPx, 0.8);
  }
  [[nodiscard]] LocalSearch SearchMap() const { return SearchMap(pose); }
};

// Points that are matched, ascending; every match must take the right keypoint.
std::vector<std::uint32_t> Matched(const std::vector<PointMatch>& matches) {
  std::vector<std::uint32_t> points;
  for (const PointMatch& match : matches) {
    EXPECT_EQ(match.keypoint, Scene::KeypointOf(match.point));
    points.push_back(match.point);
  }
  std::ranges::sort(points);
  return points;
}

// All points but these.
std::vector<std::uint32_t> AllBut(const std::vector<std::uint32_t>& missing) {
  std::vector<std::uint32_t> points;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    if (std::ranges::find(missing, i) == missing.end()) {
      points.push_back(i);
    }
  }
  return points;
}

TEST(SearchLastFrame, FindsTheKeypointsAroundAPredictedPose) {
  Scene scene;
  const Rigid3 predicted{ExpSo3({0.015, -0.025, 0}), scene.pose.translation};  // 2.5 px off either way
  EXPECT_EQ(Matched(scene.SearchLast(predicted)), AllBut({}));
  const Rigid3 wrong{ExpSo3({0.01, 0.02, 0}), scene.pose.translation};  // 25 px off
  EXPECT_TRUE(scene.SearchLast(wrong).empty());
}

TEST(SearchLastFrame, ChecksDepthOctaveTurnAndAppearance) {
  Scene scene;
  scene.Shows(1).depth_m *= 0.7F;  // in the right pixel, much nearer
  scene.Shows(2).depth_m = 0;      // nothing known of its depth: nothing to disagree
  scene.Shows(3).octave = 1;
  scene.Shows(4).octave = 2;
  scene.Shows(5).angle_deg = 120;
  for (std::uint64_t& word : scene.descriptors[Scene::KeypointOf(6)]) {
    word ^= 0xffffffffU;  // half of the bits
  }
  EXPECT_EQ(Matched(scene.SearchLast(scene.pose)), AllBut({1, 4, 5, 6}));
}

TEST(SearchLastFrame, TheWindowGrowsWithTheOctave) {
  Scene scene;
  scene.Shows(1).x += 10;  // beyond the window of octave 0
  EXPECT_EQ(Matched(scene.SearchLast(scene.pose)), AllBut({1}));
  std::vector<Keypoint> coarse(scene.last->keypoints().begin(), scene.last->keypoints().end());
  const std::vector<Descriptor> same(scene.last->descriptors().begin(), scene.last->descriptors().end());
  coarse[1].octave = scene.Shows(1).octave = 3;
  scene.last = std::make_shared<const FrameData>(TestCamera(), coarse, same);
  EXPECT_EQ(Matched(scene.SearchLast(scene.pose)), AllBut({}));
}

TEST(SearchLastFrame, TheCloserOfTwoPointsTakesAKeypoint) {
  Scene scene;
  const FrameData current = scene.Current();
  // Point 0 is said to look like point 1 and to lie there, but for some bits.
  std::vector<Descriptor> looks(scene.last->descriptors().begin(), scene.last->descriptors().end());
  looks[0] = looks[1];
  looks[0][2] ^= 0xffU;
  const std::vector<Keypoint> same(scene.last->keypoints().begin(), scene.last->keypoints().end());
  LocalMap moved = *scene.map;
  moved.x[0] = moved.x[1];
  moved.y[0] = moved.y[1];
  moved.z[0] = moved.z[1];
  const FrameData last(TestCamera(), same, looks);
  for (const auto& observations :
       {std::vector<LastObservation>{{0, 0}, {1, 1}}, std::vector<LastObservation>{{1, 1}, {0, 0}}}) {
    EXPECT_EQ(Matched(SearchLastFrame(last, observations, current, scene.pose, moved, scene.pyramid, kWindowPx)),
              (std::vector<std::uint32_t>{1}));
  }
}

TEST(SearchLocalMap, FindsTheKeypointsOfAllPointsInView) {
  Scene scene;
  const LocalSearch search = scene.SearchMap();
  EXPECT_EQ(Matched(search.matches), AllBut({}));
  EXPECT_EQ(search.visible, AllBut({}));
  const LocalSearch aside = scene.SearchMap({ExpSo3({0, 1.5, 0}), {}});  // the camera looks elsewhere
  EXPECT_TRUE(aside.visible.empty());
  const LocalSearch behind = scene.SearchMap({ExpSo3({0, 3.1, 0}), {}});
  EXPECT_TRUE(behind.visible.empty());
}

TEST(SearchLocalMap, LeavesTakenPointsAndOccupiedKeypoints) {
  Scene scene;
  scene.taken[3] = 1;
  scene.occupied[Scene::KeypointOf(4)] = 1;
  const LocalSearch search = scene.SearchMap();
  EXPECT_EQ(Matched(search.matches), AllBut({3, 4}));
  EXPECT_EQ(search.visible, AllBut({}));  // in view all the same
}

TEST(SearchLocalMap, ChecksDepthAndDistinctness) {
  Scene scene;
  scene.Shows(1).depth_m *= 0.7F;
  Keypoint twin = scene.Shows(2);  // looks nearly the same, close by
  twin.x += 1;
  Keypoint coarse = scene.Shows(3);  // the same, but of another octave
  coarse.octave = 1;
  scene.keypoints.insert(scene.keypoints.end(), {twin, coarse});
  for (const std::uint32_t point : {2U, 3U}) {
    Descriptor looks = scene.descriptors[Scene::KeypointOf(point)];
    scene.descriptors[Scene::KeypointOf(point)][0] ^= 0x1fU;  // 5 bits from the point's, the copy 6
    looks[1] ^= 0x3fU;
    scene.descriptors.push_back(looks);
  }
  scene.occupied.resize(scene.keypoints.size(), 0);
  LocalMap near = *scene.map;
  for (float& distance : near.max_distance_m) {
    distance *= 1.15F;  // points that the keyframe saw between octave 0 and 1
  }
  scene.map = std::make_shared<const LocalMap>(near);
  EXPECT_EQ(Matched(scene.SearchMap().matches), AllBut({1, 2}));
}

TEST(SearchLocalMap, PointsOutOfTheirRangeOfDistancesAreNotInView) {
  Scene scene;
  LocalMap changed = *scene.map;
  const auto distance = [&](std::size_t i) { return static_cast<float>((scene.pose * changed.Position(i)).norm()); };
  changed.max_distance_m[1] = distance(1) / 1.21F;  // too far away now
  changed.max_distance_m[2] = distance(2) / 1.19F;
  changed.min_distance_m[3] = distance(3) / 0.79F;  // too near
  changed.max_distance_m[3] = 4 * distance(3);
  changed.min_distance_m[4] = distance(4) / 0.81F;
  scene.map = std::make_shared<const LocalMap>(changed);
  EXPECT_EQ(scene.SearchMap().visible, AllBut({1, 3}));
}

TEST(SearchLocalMap, PointsSeenFromAsideAreNotInView) {
  Scene scene;
  LocalMap changed = *scene.map;
  const auto turn_normal = [&](std::size_t i, double degrees) {
    const Eigen::Vector3d ray = (changed.Position(i) - scene.pose.Inverse().translation).normalized();
    const Eigen::Vector3d axis = ray.cross(Eigen::Vector3d::UnitY()).normalized();
    const Eigen::Vector3f normal = (ExpSo3(axis * (degrees * std::numbers::pi / 180)) * ray).cast<float>();
    changed.normal_x[i] = normal.x();
    changed.normal_y[i] = normal.y();
    changed.normal_z[i] = normal.z();
  };
  turn_normal(1, 61);
  turn_normal(2, 59);
  turn_normal(3, 180);
  scene.map = std::make_shared<const LocalMap>(changed);
  EXPECT_EQ(scene.SearchMap().visible, AllBut({1, 3}));
}

}  // namespace
}  // namespace rds
