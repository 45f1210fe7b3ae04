// SPDX-License-Identifier: Apache-2.0
#include "semantic/semantic_optimizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "testing/matchers.h"
#include "testing/view.h"

namespace rds {
namespace {

constexpr int kStaticPoints = 60;
constexpr int kDynamicPoints = 40;
constexpr std::uint32_t kPoints = kStaticPoints + kDynamicPoints;
const Eigen::Vector3d kMove(0.1, 0.05, 0);  // of dynamic points since the map saw them

std::shared_ptr<const FrameData> Data(const Rigid3& camera_from_world, const std::vector<Eigen::Vector3d>& points) {
  std::vector<Keypoint> keypoints;
  for (const Eigen::Vector3d& point : points) {
    keypoints.push_back(See(camera_from_world, point));
  }
  return FrameOf(std::move(keypoints));
}

// The root and a second keyframe whose pose in the map is off by 6 cm and 2 degrees. Both see all points; those from
// kStaticPoints on have moved in between. The second keyframe has one keypoint more, free.
struct Scene {
  Map map{ScalePyramid()};
  SemanticOptimizerOptions options;
  Rigid3 truth{ExpSo3({0.02, -0.1, 0.01}), {0.3, 0.05, -0.1}};
  Rigid3 wrong = Retract((Eigen::Matrix<double, 6, 1>() << 0.04, -0.03, 0.03, 0.02, 0.02, -0.02).finished(), truth);
  Eigen::Vector3d own{0.2, 0.1, 2.2};  // of the free keypoint
  KeyframeId root;
  KeyframeId second;

  Scene() {
    Random random(3);
    std::vector<Eigen::Vector3d> points;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      points.emplace_back(random.Uniform(-0.8, 0.8), random.Uniform(-0.6, 0.6), random.Uniform(2, 4));
    }
    std::vector<Eigen::Vector3d> later = points;
    std::for_each(later.begin() + kStaticPoints, later.end(), [](Eigen::Vector3d& point) { point += kMove; });
    later.push_back(own);
    root = map.AddKeyframe(FrameId{0}, 0, {}, Data({}, points));
    second = map.AddKeyframe(FrameId{5}, 5, wrong, Data(truth, later));
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const PointId point = map.AddPoint(points[i], root, i);
      EXPECT_TRUE(map.Observe(point, second, i));
      map.SetMovingProbability(point, i < kStaticPoints ? 0.1 : 0.9);
    }
    map.UpdateCovisibility(second);
  }
  [[nodiscard]] std::optional<SemanticPoseProblem> Plan(KeyframeId keyframe) const {
    return PlanSemanticPose(map, keyframe, options);
  }
  // Whether anything was written.
  bool Apply(const SemanticPoseProblem& problem) { return Apply(SolveSemanticPose(problem, {}, options)); }
  bool Apply(const SemanticPoseProblem& problem, const PoseResult& result) {
    return Apply(SemanticCorrection(problem, result, options));
  }
  bool Apply(const std::optional<Correction>& correction) { return correction && map.Apply(*correction).poses > 0; }
  [[nodiscard]] static PoseResult Optimize(const SemanticPoseProblem& problem) {
    return OptimizePose(problem.camera, problem.camera_from_world, problem.observations);
  }
};

TEST(SemanticOptimizer, RecoversThePoseFromStaticPointsAlone) {
  Scene scene;
  const auto problem = scene.Plan(scene.second);
  ASSERT_TRUE(problem.has_value());
  ASSERT_EQ(problem->observations.size(), static_cast<std::size_t>(kStaticPoints));
  for (const PoseObservation& observation : problem->observations) {
    EXPECT_NEAR(observation.keypoint.weight, 0.9, 1e-6);
    EXPECT_TRUE(observation.keypoint.HasDepth());
  }
  ASSERT_TRUE(scene.Apply(*problem));
  EXPECT_THAT(scene.map.At(scene.second).camera_from_world, RigidNear(scene.truth, 1e-4, 0.01));
  EXPECT_GT(scene.map.At(scene.second).pose_revision, problem->keyframe.revision);
}

TEST(SemanticOptimizer, UnknownPointsDoNotTakePart) {
  Scene scene;
  for (std::uint32_t i = 0; i < 5; ++i) {
    scene.map.SetMovingProbability(PointId{i}, kUnknownProbability);
  }
  const auto problem = scene.Plan(scene.second);
  ASSERT_TRUE(problem.has_value());
  EXPECT_EQ(problem->observations.size(), static_cast<std::size_t>(kStaticPoints - 5));
}

TEST(SemanticOptimizer, RefusesTooFewStaticPoints) {
  Scene scene;
  scene.options.min_static = kStaticPoints;
  EXPECT_TRUE(scene.Plan(scene.second).has_value());
  scene.options.min_static = kStaticPoints + 1;
  EXPECT_FALSE(scene.Plan(scene.second).has_value());
}

TEST(SemanticOptimizer, RefusesTheRootAndKeyframesThatAreGone) {
  Scene scene;
  EXPECT_FALSE(scene.Plan(scene.root).has_value());
  const auto problem = scene.Plan(scene.second);
  ASSERT_TRUE(problem.has_value());
  scene.map.EraseKeyframe(scene.second);
  EXPECT_FALSE(scene.Plan(scene.second).has_value());
  EXPECT_FALSE(scene.Apply(*problem));
}

TEST(SemanticOptimizer, LeavesAPoseAloneThatChangedMeanwhile) {
  Scene scene;
  const auto problem = scene.Plan(scene.second);
  ASSERT_TRUE(problem.has_value());
  const Rigid3 changed{ExpSo3({0, -0.1, 0}), {0.31, 0.05, -0.1}};
  scene.map.SetPose(scene.second, changed);
  EXPECT_FALSE(scene.Apply(*problem));
  EXPECT_THAT(scene.map.At(scene.second).camera_from_world, RigidNear(changed, 0.0, 1e-6));
}

TEST(SemanticOptimizer, LeavesAPoseAloneThatFewInliersAgreeWith) {
  Scene scene;
  const auto problem = scene.Plan(scene.second);
  ASSERT_TRUE(problem.has_value());
  PoseResult result = Scene::Optimize(*problem);
  result.converged = false;
  EXPECT_FALSE(scene.Apply(*problem, result));
  result.converged = true;
  result.inliers = scene.options.min_static - 1;
  EXPECT_FALSE(scene.Apply(*problem, result));
  EXPECT_EQ(scene.map.At(scene.second).pose_revision, problem->keyframe.revision);
  result.inliers = scene.options.min_static;
  EXPECT_TRUE(scene.Apply(*problem, result));
}

TEST(SemanticOptimizer, WritesNoCorrectionThatIsNoise) {
  const auto writes = [](double shift_m, double turn_deg) {
    Scene scene;
    const auto problem = scene.Plan(scene.second);
    EXPECT_TRUE(problem.has_value());
    const Rigid3 before = scene.wrong.Inverse();
    const Rigid3 after{before.rotation * ExpSo3({0, turn_deg * std::numbers::pi / 180, 0}),
                       before.translation + Eigen::Vector3d(shift_m, 0, 0)};
    PoseResult result = Scene::Optimize(*problem);
    result.camera_from_world = after.Inverse();
    const bool written = scene.Apply(*problem, result);
    EXPECT_EQ(scene.map.At(scene.second).pose_revision, problem->keyframe.revision + (written ? 1 : 0));
    return written;
  };
  EXPECT_FALSE(writes(0.0019, 0.049));
  EXPECT_TRUE(writes(0.0021, 0));
  EXPECT_TRUE(writes(0, 0.051));
}

TEST(SemanticOptimizer, PointsThatThisKeyframeMadeMoveWithItThoughLaterOnesSeeThem) {
  Scene scene;
  // Placed from the keyframe's depth at the wrong pose, as mapping does.
  const PointId own = scene.map.AddPoint(scene.wrong.Inverse() * (scene.truth * scene.own), scene.second, kPoints);
  scene.map.SetMovingProbability(own, 0.1);
  const KeyframeId third = scene.map.AddKeyframe(FrameId{9}, 9, scene.truth, Data(scene.truth, {scene.own}));
  ASSERT_TRUE(scene.map.Observe(own, third, 0));
  ASSERT_GT((scene.map.At(own).position - scene.own).norm(), 0.02);
  const Eigen::Vector3d shared = scene.map.At(PointId{0}).position;
  const auto problem = scene.Plan(scene.second);
  ASSERT_TRUE(problem.has_value());
  EXPECT_EQ(problem->observations.size(), static_cast<std::size_t>(kStaticPoints));  // it says nothing of the pose
  ASSERT_TRUE(scene.Apply(*problem));
  EXPECT_THAT(scene.map.At(own).position, MatrixNear(scene.own, 1e-3));
  EXPECT_EQ(scene.map.At(PointId{0}).position, shared);
  const Eigen::Vector3d ray = scene.own - scene.truth.Inverse().translation;
  EXPECT_THAT(scene.map.At(own).normal, MatrixNear(ray.normalized().eval(), 1e-3));
  // To the later keyframe it is a point of an older one: it takes part there.
  scene.options.min_static = 1;
  ASSERT_TRUE(scene.Plan(third).has_value());
  EXPECT_EQ(scene.Plan(third)->observations.size(), 1U);
}

}  // namespace
}  // namespace rds
