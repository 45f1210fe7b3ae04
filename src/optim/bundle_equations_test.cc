// SPDX-License-Identifier: Apache-2.0
#include "optim/bundle_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "base/random.h"

namespace rds {
namespace {

constexpr int kPoses = 5;
constexpr int kFixed = 2;
constexpr int kPoints = 20;
constexpr Eigen::Index kSize = 6 * (kPoses - kFixed) + 3 * kPoints;

// Cameras beside each other, every second observation without depth, weights of all sizes, errors of `error_px`.
BundleProblem MakeProblem(double error_px) {
  Random random(1);
  BundleProblem problem;
  problem.camera.fx = 525;
  problem.camera.fy = 520;
  problem.camera.cx = 320;
  problem.camera.cy = 240;
  for (int i = 0; i < kPoses; ++i) {
    problem.poses.push_back({{ExpSo3({0.1, 0.1 * i, 0.05}), {-0.2 * i, 0.1, 0.05 * i}}, i < kFixed});
  }
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    problem.points.emplace_back(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(2, 4));
    for (std::uint32_t pose = 0; pose < kPoses; ++pose) {
      const Eigen::Vector3d in_camera = problem.poses[pose].camera_from_world * problem.points[i];
      BundleProblem::Observation observation{pose, i, {}};
      PixelObservation& keypoint = observation.keypoint;
      keypoint.pixel =
          problem.camera.Project(in_camera) + error_px * Eigen::Vector2d(random.Uniform(-1, 1), random.Uniform(-1, 1));
      if ((pose + i) % 2 == 0) {
        keypoint.depth_px = random.Uniform(40, 80);
        keypoint.inverse_depth = 1 / in_camera.z() + error_px / keypoint.depth_px * random.Uniform(-1, 1);
      }
      keypoint.inverse_sigma2 = random.Uniform(0.3, 1);
      keypoint.weight = random.Uniform(0.2, 1);
      problem.observations.push_back(observation);
    }
  }
  problem.observations.push_back(problem.observations[7]);  // seen twice by the same camera
  problem.observations.back().keypoint.pixel.x() += error_px;
  return problem;
}

// Applies a change of the free poses, then the points.
void Move(const Eigen::VectorXd& change, std::vector<Rigid3>* poses, std::vector<Eigen::Vector3d>* points) {
  for (std::size_t i = kFixed; i < kPoses; ++i) {
    (*poses)[i] = Retract(change.segment<6>(6 * static_cast<Eigen::Index>(i - kFixed)), (*poses)[i]);
  }
  for (std::size_t i = 0; i < kPoints; ++i) {
    (*points)[i] += change.segment<3>(6 * (kPoses - kFixed) + 3 * static_cast<Eigen::Index>(i));
  }
}

std::vector<Rigid3> InitialPoses(const BundleProblem& problem) {
  std::vector<Rigid3> poses;
  for (const BundleProblem::Pose& pose : problem.poses) {
    poses.push_back(pose.camera_from_world);
  }
  return poses;
}

// All residuals, weighted, after a change.
Eigen::VectorXd Residuals(const BundleProblem& problem, const Eigen::VectorXd& change) {
  std::vector<Rigid3> poses = InitialPoses(problem);
  std::vector<Eigen::Vector3d> points = problem.points;
  Move(change, &poses, &points);
  Eigen::VectorXd residuals(3 * static_cast<Eigen::Index>(problem.observations.size()));
  Eigen::Index at = 0;
  for (const BundleProblem::Observation& observation : problem.observations) {
    const PixelObservation& keypoint = observation.keypoint;
    const Eigen::Vector3d in_camera = poses[observation.pose] * points[observation.point];
    const Eigen::Vector2d projected = problem.camera.Project(in_camera);
    residuals.segment<2>(at) = keypoint.pixel - projected;
    residuals[at + 2] = keypoint.depth_px * (keypoint.inverse_depth - 1 / in_camera.z());
    residuals.segment<3>(at) *= keypoint.weight * std::sqrt(keypoint.inverse_sigma2);
    at += 3;
  }
  return residuals;
}

// What one large dense system made of numeric derivatives says, each observation scaled by the root of its `weight`.
struct Reference {
  Eigen::VectorXd step;
  double decrease = 0;
};

Reference SolveReference(const BundleProblem& problem, const Eigen::VectorXd& weight) {
  const Eigen::VectorXd residuals = Residuals(problem, Eigen::VectorXd::Zero(kSize));
  Eigen::MatrixXd jacobian(residuals.size(), kSize);
  for (Eigen::Index i = 0; i < kSize; ++i) {
    const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(kSize, i);
    jacobian.col(i) = (Residuals(problem, step) - Residuals(problem, -step)) / 2e-5;
  }
  const Eigen::VectorXd gradient = jacobian.transpose() * weight.asDiagonal() * residuals;
  const Eigen::MatrixXd hessian = jacobian.transpose() * weight.asDiagonal() * jacobian;
  Reference reference;
  reference.step = -hessian.ldlt().solve(gradient);
  reference.decrease = -0.5 * gradient.dot(reference.step);
  return reference;
}

void ExpectStep(const BundleProblem& problem, bool robust, const Reference& reference) {
  const BundleOptions options;
  BundleEquations equations(problem, options);
  equations.Linearize(robust);
  EXPECT_NEAR(equations.FindStep(0), reference.decrease, 1e-5 * reference.decrease);
  equations.TakeStep();
  std::vector<Rigid3> poses = InitialPoses(problem);
  std::vector<Eigen::Vector3d> points = problem.points;
  Move(reference.step, &poses, &points);
  const double tolerance = 1e-5 * reference.step.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Rigid3 pose = equations.Poses()[i];
    EXPECT_LT((pose.translation - poses[i].translation).norm(), tolerance) << i;
    EXPECT_LT(AngleOf(pose.rotation * poses[i].rotation.conjugate()), tolerance) << i;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((equations.points()[i] - points[i]).norm(), tolerance) << i;
  }
}

TEST(BundleEquations, StepIsThatOfOneDenseSystemOfNumericDerivatives) {
  const BundleProblem problem = MakeProblem(0.5);
  const auto rows = 3 * static_cast<Eigen::Index>(problem.observations.size());
  ExpectStep(problem, false, SolveReference(problem, Eigen::VectorXd::Ones(rows)));
}

TEST(BundleEquations, RobustStepReweightsLargeResiduals) {
  const BundleProblem problem = MakeProblem(6);
  const Eigen::VectorXd residuals = Residuals(problem, Eigen::VectorXd::Zero(kSize));
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(residuals.size());
  int reweighted = 0;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    const double norm = residuals.segment<3>(at).norm();
    const double huber =
        problem.observations[i].keypoint.HasDepth() ? BundleOptions().huber_depth : BundleOptions().huber_mono;
    if (norm > huber) {
      weight.segment<3>(at).setConstant(huber / norm);
      ++reweighted;
    }
  }
  ASSERT_GT(reweighted, 10);
  ExpectStep(problem, true, SolveReference(problem, weight));
}

TEST(BundleEquations, CostIsHalfTheSumOfSquares) {
  const BundleProblem problem = MakeProblem(0.5);
  const BundleOptions options;
  const BundleEquations equations(problem, options);
  const double expected = 0.5 * Residuals(problem, Eigen::VectorXd::Zero(kSize)).squaredNorm();
  EXPECT_NEAR(equations.Cost(false), expected, 1e-9 * expected);
  EXPECT_NEAR(equations.Cost(true), expected, 1e-9 * expected);  // all within the kernel's quadratic part
}

TEST(BundleEquations, DampingShortensTheStep) {
  const BundleProblem problem = MakeProblem(0.5);
  const BundleOptions options;
  BundleEquations equations(problem, options);
  equations.Linearize(false);
  const double full = equations.FindStep(0);
  const double damped = equations.FindStep(1);
  EXPECT_GT(damped, 0);
  EXPECT_LT(damped, full);
  EXPECT_LT(equations.FindStep(1e6), 1e-3 * full);
}

TEST(BundleEquations, TakeBackReturnsToTheByte) {
  const BundleProblem problem = MakeProblem(0.5);
  const BundleOptions options;
  BundleEquations equations(problem, options);
  equations.Linearize(false);
  ASSERT_GT(equations.FindStep(1e-3), 0);
  equations.TakeStep();
  EXPECT_NE(equations.points(), problem.points);
  equations.Revert();
  EXPECT_EQ(equations.points(), problem.points);
  for (std::size_t i = 0; i < kPoses; ++i) {
    EXPECT_EQ(equations.Poses()[i].translation, problem.poses[i].camera_from_world.translation);
    EXPECT_EQ(equations.Poses()[i].rotation.coeffs(), problem.poses[i].camera_from_world.rotation.coeffs());
  }
}

TEST(BundleEquations, DroppedOutliersHaveNoSay) {
  BundleProblem problem = MakeProblem(0.5);
  const BundleOptions options;
  const double without = BundleEquations(problem, options).Cost(false);
  BundleProblem::Observation outlier = problem.observations[11];
  outlier.keypoint.pixel.y() += 40;
  problem.observations.push_back(outlier);
  BundleEquations equations(problem, options);
  EXPECT_GT(equations.Cost(false), without + 1);
  equations.DropOutliers();
  EXPECT_NEAR(equations.Cost(false), without, 1e-9 * without);
}

}  // namespace
}  // namespace rds
