// SPDX-License-Identifier: Apache-2.0
#include "optim/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/random.h"
#include "testing/matchers.h"

namespace rds {
namespace {

constexpr double kNoise_m = 0.005;
constexpr double kNoise_rad = 0.0035;

Rigid3 Noise(Random& random, double scale = 1) {
  Tangent6 tangent;
  for (int i = 0; i < 6; ++i) {
    tangent[i] = scale * random.Gaussian(0, i < 3 ? kNoise_m : kNoise_rad);
  }
  return Retract(tangent, {});
}

// Cameras once round a circle of 5 m radius, each measured from the one before with noise; and as the measurements put
// them one after the other.
struct Ring {
  std::vector<Rigid3> truth;
  PoseGraphProblem problem;

  explicit Ring(std::uint32_t count, std::uint64_t seed = 1) {
    Random random(seed);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      const Rigid3 world_from_camera{ExpSo3({0, angle, 0}), {5 * std::sin(angle), 0, 5 * std::cos(angle)}};
      truth.push_back(world_from_camera.Inverse());
      if (i == 0) {
        problem.poses.push_back({truth[0], true});
      } else {
        Connect(i - 1, i, random);
        problem.poses.push_back({problem.edges.back().to_from_from * problem.poses.back().camera_from_world});
      }
    }
  }
  void Connect(std::uint32_t from, std::uint32_t to, Random& random, bool robust = false) {
    problem.edges.push_back(
        {from, to, Noise(random) * truth[to] * truth[from].Inverse(), kNoise_m, kNoise_rad, robust});
  }
  [[nodiscard]] double Rmse(const std::vector<Rigid3>& poses) const {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      sum += (poses[i].Inverse().translation - truth[i].Inverse().translation).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
  [[nodiscard]] double DriftRmse() const {
    std::vector<Rigid3> poses;
    for (const auto& pose : problem.poses) {
      poses.push_back(pose.camera_from_world);
    }
    return Rmse(poses);
  }
};

// Of a long chain, whose bending as a whole is 10 million times softer than one pose alone.
TEST(PoseGraph, ALoopOfTenThousandIsBentToTheEnd) {
  constexpr std::uint32_t kCount = 10'000;
  constexpr double kRadius_m = 400;
  constexpr double kTurn_rad = 1e-5;
  std::vector<Rigid3> truth;
  PoseGraphProblem problem;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCount;
    truth.push_back(
        Rigid3{ExpSo3({0, angle, 0}), {kRadius_m * std::sin(angle), 0, kRadius_m * std::cos(angle)}}.Inverse());
    problem.poses.push_back({truth[i], i == 0});
    if (i > 0) {
      Rigid3 motion = truth[i] * truth[i - 1].Inverse();
      motion.rotation = ExpSo3({0, kTurn_rad, 0}) * motion.rotation;
      problem.poses[i].camera_from_world = motion * problem.poses[i - 1].camera_from_world;
      problem.edges.push_back({i - 1, i, motion});
    }
  }
  problem.edges.push_back({0, kCount - 1, truth[kCount - 1] * truth[0].Inverse()});
  const PoseGraphResult result = OptimizePoseGraph(problem);
  ASSERT_TRUE(result.usable);
  EXPECT_LT(result.iterations, 10);
  for (std::size_t i = 0; i < truth.size(); i += 100) {
    EXPECT_LT((result.poses[i].Inverse().translation - truth[i].Inverse().translation).norm(), 0.1) << i;
  }
}

TEST(PoseGraph, ALoopTakesTheDriftAway) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Ring ring(400, seed);
    Random random(seed + 100);
    ring.Connect(0, 399, random);
    const PoseGraphResult result = OptimizePoseGraph(ring.problem);
    ASSERT_TRUE(result.usable);
    EXPECT_LT(ring.Rmse(result.poses), 0.8 * ring.DriftRmse()) << seed;
    EXPECT_LT((result.poses[399].Inverse().translation - ring.truth[399].Inverse().translation).norm(), 0.03);
    EXPECT_THAT(result.poses[0], RigidNear(ring.truth[0], 1e-12, 1e-6));
    for (const double chi2 : result.chi2) {
      EXPECT_LT(chi2, 22.5);
    }
  }
}

TEST(PoseGraph, WithoutLoopsNothingMoves) {
  const Ring ring(50);
  const PoseGraphResult result = OptimizePoseGraph(ring.problem);
  ASSERT_TRUE(result.usable);
  for (std::size_t i = 0; i < ring.truth.size(); ++i) {
    EXPECT_THAT(result.poses[i], RigidNear(ring.problem.poses[i].camera_from_world, 1e-9, 1e-6));
  }
}

TEST(PoseGraph, AWrongLoopIsOverruledByRightOnesAndSaysSo) {
  Ring ring(400);
  Random random(7);
  for (const std::uint32_t i : {0U, 10U, 20U}) {
    ring.Connect(i, 399 - i, random, true);
  }
  const double right = ring.Rmse(OptimizePoseGraph(ring.problem).poses);
  ring.problem.edges.push_back({100, 300, Rigid3{}, kNoise_m, kNoise_rad, true});
  const PoseGraphResult result = OptimizePoseGraph(ring.problem);
  ASSERT_TRUE(result.usable);
  EXPECT_LT(ring.Rmse(result.poses), 1.2 * right + 0.01);
  EXPECT_GT(result.chi2.back(), 1000);
}

TEST(PoseGraph, StandsAtTheMinimumOfItsCost) {
  Ring ring(30);
  Random random(3);
  ring.Connect(0, 29, random);
  ring.Connect(5, 20, random);
  const PoseGraphResult result = OptimizePoseGraph(ring.problem, 50);
  const auto cost = [&](const std::vector<Rigid3>& poses) {
    double sum = 0;
    for (const auto& edge : ring.problem.edges) {
      const Rigid3 error = edge.to_from_from.Inverse() * (poses[edge.to] * poses[edge.from].Inverse());
      sum += error.translation.squaredNorm() / (edge.sigma_m * edge.sigma_m) +
             LogSo3(error.rotation).squaredNorm() / (edge.sigma_rad * edge.sigma_rad);
    }
    return sum;
  };
  const double least = cost(result.poses);
  for (const std::size_t i : {1U, 7U, 29U}) {
    for (int axis = 0; axis < 6; ++axis) {
      for (const double by : {-1e-4, 1e-4}) {
        std::vector<Rigid3> moved = result.poses;
        moved[i] = Retract(by * Tangent6::Unit(axis), moved[i]);
        EXPECT_GT(cost(moved), least) << i << " " << axis;
      }
    }
  }
}

TEST(PoseGraph, NothingToDoAndBadIndices) {
  EXPECT_FALSE(OptimizePoseGraph({}).usable);
  PoseGraphProblem problem;
  problem.poses.push_back({{}, true});
  EXPECT_FALSE(OptimizePoseGraph(problem).usable);
  problem.edges.push_back({0, 1, {}});
  EXPECT_THROW(static_cast<void>(OptimizePoseGraph(problem)), InvariantError);
}

TEST(PoseGraph, CanBeStopped) {
  Ring ring(100);
  Random random(3);
  ring.Connect(0, 99, random);
  int polled = 0;
  EXPECT_FALSE(OptimizePoseGraph(ring.problem, 20, [&] { return ++polled > 1; }).usable);
}

}  // namespace
}  // namespace rds
