// SPDX-License-Identifier: Apache-2.0
// Each way to a first pose alone.
#include "tracking/coarse_pose.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "testing/matchers.h"
#include "testing/point_world.h"

namespace rds {
namespace {

constexpr std::uint32_t kPoints = 300;
const Rigid3 kKeyframe{};
const Rigid3 kLast{ExpSo3({0, 0.02, 0}), {-0.04, 0, 0}};
const Rigid3 kNow{ExpSo3({0, 0.03, 0}), {-0.06, 0, 0}};

// A map of one keyframe, a last frame that was tracked, and the frame of the moment.
struct Scene {
  PointWorld world{kPoints};
  Map map{ScalePyramid()};
  std::shared_ptr<const LocalMap> local;
  PointWorld::View last;
  std::vector<LastObservation> observations;
  PointWorld::View now;
  TrackerOptions options;
  TrackerSetup setup;
  StageTimes times;

  Scene() {
    world.AddTo(map, FrameId{0}, kKeyframe, world.Look(kKeyframe));
    local = BuildLocalMap(map, KeyframeId{0}, {});
    last = world.Look(kLast);
    std::vector<PointId> points;
    for (const std::uint32_t point : last.points) {
      points.push_back(world.IdOf(point));
    }
    observations = FindObservations(points, *local);
    now = world.Look(kNow);
  }
  [[nodiscard]] FrameContext Context() {
    return {*now.data, *local, map.probabilities(), nullptr, options, setup, times};
  }
  [[nodiscard]] std::optional<PoseEstimate> FromLastFrame(const Rigid3& expected) {
    return TrackLastFrame(Context(), *last.data, observations, {expected, std::nullopt});
  }
};

TEST(TrackLastFrame, FindsThePoseFromARoughOne) {
  Scene scene;
  const auto estimate = scene.FromLastFrame(kLast);
  ASSERT_TRUE(estimate.has_value());
  EXPECT_THAT(estimate->camera_from_world, RigidNear(kNow, 1e-3, 0.02));
  EXPECT_GT(estimate->association.used.size(), 150U);
  EXPECT_FALSE(estimate->prior.has_value());
}

TEST(TrackLastFrame, GivesNothingFarFromThePoseOrWithoutPoints) {
  Scene scene;
  EXPECT_FALSE(scene.FromLastFrame({ExpSo3({0, 0.8, 0}), {}}).has_value());
  scene.observations.clear();
  EXPECT_FALSE(scene.FromLastFrame(kLast).has_value());
}

TEST(TrackLastFrame, KeepsThePriorThatItWasGiven) {
  Scene scene;
  PosePrior prior{kNow, 1e8 * Eigen::Matrix<double, 6, 6>::Identity()};
  const auto estimate = TrackLastFrame(scene.Context(), *scene.last.data, scene.observations, {kNow, prior});
  ASSERT_TRUE(estimate.has_value());
  ASSERT_TRUE(estimate->prior.has_value());
  EXPECT_THAT(estimate->camera_from_world, RigidNear(kNow, 1e-4, 0.002));
}

TEST(TrackKeyframe, FindsThePoseByAppearance) {
  Scene scene;
  const auto estimate = TrackKeyframe(scene.Context(), scene.local->keyframes[0], kKeyframe);
  ASSERT_TRUE(estimate.has_value());
  EXPECT_THAT(estimate->camera_from_world, RigidNear(kNow, 1e-3, 0.02));
}

TEST(TrackKeyframe, GivesNothingWhereTheFrameShowsSomethingElse) {
  Scene scene;
  scene.now = PointWorld(kPoints, 77).Look(kNow);
  EXPECT_FALSE(TrackKeyframe(scene.Context(), scene.local->keyframes[0], kKeyframe).has_value());
  EXPECT_FALSE(RecoverPose(scene.Context(), kKeyframe).has_value());
}

TEST(RecoverPose, FindsAPoseThatNothingLedTo) {
  Scene scene;
  const Rigid3 far{ExpSo3({0.1, 0.1, 0.5}), {-0.3, 0.2, 0.4}};
  scene.now = scene.world.Look(far);
  const auto estimate = RecoverPose(scene.Context(), {Eigen::Quaterniond::Identity(), {9, 9, 9}});
  ASSERT_TRUE(estimate.has_value());
  EXPECT_THAT(estimate->camera_from_world, RigidNear(far, 2e-3, 0.05));
}

TEST(RecoverPose, IsNotLuredByDynamicPoints) {
  Scene scene;
  constexpr std::uint32_t kMoving = 200;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    if (scene.world.IdOf(i).valid()) {
      scene.map.SetMovingProbability(scene.world.IdOf(i), i < kMoving ? 0.9 : 0.1);
    }
  }
  scene.world.Move(0, kMoving, {0.5, 0, 0});
  scene.now = scene.world.Look(kNow);
  const auto estimate = RecoverPose(scene.Context(), kKeyframe);
  ASSERT_TRUE(estimate.has_value());
  EXPECT_THAT(estimate->camera_from_world, RigidNear(kNow, 2e-3, 0.05));
}

TEST(ResolveDeferred, LetsUnknownPointsInWhereStaticOnesAreFewAndTheyAgree) {
  for (const int still : {30, 200}) {
    Scene scene;
    std::vector<PointMatch> matches;
    for (std::uint32_t i = 0; i < scene.now.points.size(); ++i) {
      const auto point = scene.local->IndexOf(scene.world.IdOf(scene.now.points[i]));
      if (!point) {
        continue;
      }
      scene.map.SetMovingProbability(scene.local->ids[*point], std::ssize(matches) < still ? 0.1 : 0.5);
      matches.push_back({i, *point, PointState::kUnknown, 1});
    }
    ASSERT_GT(std::ssize(matches), still + 5);
    std::swap(matches[matches.size() - 1].point, matches[matches.size() - 2].point);  // these cannot agree
    PoseEstimate estimate = EstimatePose(scene.Context(), kLast, std::nullopt, matches);
    EXPECT_EQ(std::ssize(estimate.association.used), still);
    ResolveDeferred(scene.Context(), estimate);
    const auto agreeing = std::ssize(matches) - 2;
    EXPECT_EQ(std::ssize(estimate.association.used), still < 60 ? agreeing : still);
    EXPECT_EQ(std::ssize(estimate.association.deferred), still < 60 ? 0 : agreeing - still);
    EXPECT_EQ(estimate.outliers.size(), 2U);
    EXPECT_THAT(estimate.camera_from_world, RigidNear(kNow, 1e-3, 0.02));
  }
}

}  // namespace
}  // namespace rds
