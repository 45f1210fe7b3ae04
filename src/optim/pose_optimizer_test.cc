// SPDX-License-Identifier: Apache-2.0
#include "optim/pose_optimizer.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstring>

#include "base/error.h"
#include "base/random.h"
#include "geometry/numeric_jacobian.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = 525;
  camera.fy = 520;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

const Rigid3 kTruth{ExpSo3({0.3, -0.2, 0.1}), {0.5, -0.2, 1.0}};

Rigid3 Start(double offset) {
  Vector6 delta;
  delta << 1, -1, 1, 0.5, -0.5, 0.5;
  return Retract(offset * delta, kTruth);
}

PoseObservation Observe(const Rigid3& camera_from_world, const Eigen::Vector3d& point_in_camera, bool has_depth) {
  const PinholeCamera camera = TestCamera();
  PoseObservation observation;
  observation.point_in_world = camera_from_world.Inverse() * point_in_camera;
  observation.keypoint.pixel = camera.Project(point_in_camera);
  if (has_depth) {
    observation.keypoint.inverse_depth = 1 / point_in_camera.z();
    observation.keypoint.depth_px = 40;
  }
  return observation;
}

// Observations from kTruth: noise in standard deviations, every third one without depth. Outliers come first.
std::vector<PoseObservation> Scene(int count, double noise, int outliers, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d pixel(random.Uniform(10, 630), random.Uniform(10, 470));
    PoseObservation observation = Observe(kTruth, TestCamera().Unproject(pixel, random.Uniform(0.7, 6)), i % 3 != 0);
    PixelObservation& keypoint = observation.keypoint;
    const double sigma_px = std::pow(1.2, random.Index(8));
    keypoint.inverse_sigma2 = 1 / (sigma_px * sigma_px);
    keypoint.pixel += noise * sigma_px * Eigen::Vector2d(random.Gaussian(0, 1), random.Gaussian(0, 1));
    if (keypoint.HasDepth()) {
      keypoint.inverse_depth += noise * sigma_px / keypoint.depth_px * random.Gaussian(0, 1);
    }
    if (i < outliers) {
      keypoint.pixel += Eigen::Vector2d(random.Uniform(30, 80), random.Uniform(-80, -30));
    }
    observations.push_back(observation);
  }
  return observations;
}

double DistanceFromTruth(const Rigid3& camera_from_world) {
  return (camera_from_world.Inverse().translation - kTruth.Inverse().translation).norm() +
         AngleOf(camera_from_world.rotation * kTruth.rotation.conjugate());
}

void ExpectSameBytes(const Rigid3& a, const Rigid3& b) {
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

// The residual at a pose; the optimizer never forms it, nor its Jacobian, which is taken by differences here.
Eigen::Vector3d Residual(const Rigid3& camera_from_world, const PoseObservation& observation) {
  return ReprojectionError(TestCamera(), observation.keypoint, camera_from_world * observation.point_in_world);
}

TEST(OptimizePose, FindsTheExactPoseWithoutNoise) {
  const PoseResult result = OptimizePose(TestCamera(), Start(0.1), Scene(60, 0, 0));
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.inliers, 60);
  EXPECT_LT(DistanceFromTruth(result.camera_from_world), 1e-9);
}

TEST(OptimizePose, FindsThePoseWithManyOutliersAndNoise) {
  for (const double offset : {0.0, 0.03, 0.1}) {
    const PoseResult result = OptimizePose(TestCamera(), Start(offset), Scene(500, 0.7, 200));
    EXPECT_TRUE(result.converged);
    EXPECT_LT(DistanceFromTruth(result.camera_from_world), 2e-3);
    int flagged = 0;
    for (std::size_t i = 0; i < 200; ++i) {
      flagged += result.inlier[i] == 0 ? 1 : 0;
    }
    EXPECT_GT(flagged, 195);         // at 4 sigma_px and more of the coarsest level all but a few stand out
    EXPECT_GT(result.inliers, 295);  // of 300, at 0.7 standard deviations
    EXPECT_EQ(result.inliers, std::count(result.inlier.begin(), result.inlier.end(), 1));
  }
}

TEST(OptimizePose, WeightsEnterResidualAndJacobian) {
  // Near the solution the problem is linear: compare with weighted least squares in closed form, weight^2 in the cost.
  std::vector<PoseObservation> observations = Scene(40, 0.3, 0);
  Random random(5);
  for (PoseObservation& observation : observations) {
    observation.keypoint.weight = random.Uniform(0.1, 1);
  }
  const PoseResult result = OptimizePose(TestCamera(), kTruth, observations);
  ASSERT_EQ(result.inliers, 40);
  Rigid3 expected = kTruth;
  Eigen::Matrix<double, 6, 6> hessian;
  for (int iteration = 0; iteration < 10; ++iteration) {
    hessian.setZero();
    Vector6 gradient = Vector6::Zero();
    for (const PoseObservation& observation : observations) {
      const Eigen::Vector3d residual = Residual(expected, observation);
      const auto moved = [&](const Vector6& delta) { return Residual(Retract(delta, expected), observation); };
      const Eigen::Matrix<double, 3, 6> jacobian = NumericJacobian<3, 6>(moved, Vector6::Zero().eval());
      const double weight = observation.keypoint.weight * observation.keypoint.weight;
      hessian += weight * observation.keypoint.inverse_sigma2 * jacobian.transpose() * jacobian;
      gradient += weight * observation.keypoint.inverse_sigma2 * jacobian.transpose() * residual;
    }
    expected = Retract(-hessian.ldlt().solve(gradient), expected);
  }
  EXPECT_LT((result.camera_from_world.translation - expected.translation).norm(), 1e-7);
  EXPECT_LT(AngleOf(result.camera_from_world.rotation * expected.rotation.conjugate()), 1e-7);
  EXPECT_TRUE(result.information.isApprox(hessian, 1e-5));
  EXPECT_EQ(result.information, result.information.transpose());
}

TEST(OptimizePose, ZeroWeightHasNoInfluence) {
  std::vector<PoseObservation> observations = Scene(80, 0.7, 0);
  const PoseResult without = OptimizePose(TestCamera(), Start(0.02), observations);
  Random random(9);
  for (int i = 0; i < 80; ++i) {  // a moving object, consistent in itself: as many observations again
    const Eigen::Vector2d pixel(random.Uniform(100, 300), random.Uniform(10, 470));
    PoseObservation observation = Observe(Start(-0.03), TestCamera().Unproject(pixel, random.Uniform(0.7, 2)), true);
    observation.keypoint.weight = 0;
    observations.push_back(observation);
  }
  const PoseResult with = OptimizePose(TestCamera(), Start(0.02), observations);
  ASSERT_TRUE(with.converged);
  EXPECT_LT((with.camera_from_world.translation - without.camera_from_world.translation).norm(), 1e-9);
  EXPECT_LT(AngleOf(with.camera_from_world.rotation * without.camera_from_world.rotation.conjugate()), 1e-9);
}

TEST(OptimizePose, InliersAreJudgedWithoutTheWeight) {
  std::vector<PoseObservation> observations = Scene(50, 0, 10);
  for (std::size_t i = 0; i < 5; ++i) {
    observations[i].keypoint.weight = 0;       // outlier, weight must not hide it
    observations[20 + i].keypoint.weight = 0;  // inlier although it has no say
  }
  const PoseResult result = OptimizePose(TestCamera(), Start(0.01), observations);
  EXPECT_EQ(result.inliers, 40);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(result.inlier[i], i < 10 ? 0 : 1) << i;
  }
}

void ExpectFailure(const PoseResult& result, const Rigid3& initial, std::size_t count) {
  EXPECT_FALSE(result.converged);
  ExpectSameBytes(result.camera_from_world, initial);
  EXPECT_EQ(result.inlier.size(), count);
}

TEST(OptimizePose, FailsWithFewerThanThreeObservations) {
  for (const int count : {0, 1, 2}) {
    ExpectFailure(OptimizePose(TestCamera(), Start(0.01), Scene(count, 0, 0)), Start(0.01),
                  static_cast<std::size_t>(count));
  }
}

TEST(OptimizePose, SolvesWithThreeObservationsWithDepth) {
  std::vector<PoseObservation> observations;
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.5, 0.1, 2), {-0.5, 0.3, 1.5}, {0.1, -0.6, 2.5}}) {
    observations.push_back(Observe(kTruth, point, true));
  }
  const PoseResult result = OptimizePose(TestCamera(), Start(0.02), observations);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(DistanceFromTruth(result.camera_from_world), 1e-8);
}

TEST(OptimizePose, FailsOnCollinearPoints) {  // free to rotate about the line
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 10; ++i) {
    observations.push_back(
        Observe(kTruth, Eigen::Vector3d(-0.5, 0.2, 1.5) + 0.1 * i * Eigen::Vector3d(1, 0.3, 0.5), true));
  }
  ExpectFailure(OptimizePose(TestCamera(), Start(0.01), observations), Start(0.01), 10);
}

TEST(OptimizePose, FailsOnASinglePointSeenOften) {
  const std::vector<PoseObservation> observations(20, Observe(kTruth, {0.1, 0.2, 2}, true));
  ExpectFailure(OptimizePose(TestCamera(), kTruth, observations), kTruth, 20);
}

TEST(OptimizePose, FailsIfEverythingIsBehindTheCamera) {
  std::vector<PoseObservation> observations = Scene(30, 0, 0);
  for (PoseObservation& observation : observations) {
    observation.point_in_world = kTruth.Inverse() * -(kTruth * observation.point_in_world);
  }
  const PoseResult result = OptimizePose(TestCamera(), kTruth, observations);
  ExpectFailure(result, kTruth, 30);
  EXPECT_EQ(result.inliers, 0);
}

TEST(OptimizePose, FailsIfNothingHasAnyWeight) {
  std::vector<PoseObservation> observations = Scene(30, 0, 0);
  for (PoseObservation& observation : observations) {
    observation.keypoint.weight = 0;
  }
  const PoseResult result = OptimizePose(TestCamera(), kTruth, observations);
  ExpectFailure(result, kTruth, 30);
  EXPECT_EQ(result.inliers, 30);
}

TEST(OptimizePose, PointsBehindTheCameraAreOutliers) {
  std::vector<PoseObservation> observations = Scene(50, 0, 0);
  // On the optical axis: the projection alone would be perfect.
  observations[7] = Observe(kTruth, {0, 0, 1}, false);
  observations[7].point_in_world = kTruth.Inverse() * Eigen::Vector3d(0, 0, -1);
  const PoseResult result = OptimizePose(TestCamera(), Start(0.02), observations);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.inlier[7], 0);
  EXPECT_EQ(result.inliers, 49);
}

TEST(OptimizePose, IgnoresNonsense) {
  std::vector<PoseObservation> observations = Scene(50, 0, 0);
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  observations[0].point_in_world.x() = nan;
  observations[1].keypoint.pixel.x() = nan;
  observations[2].keypoint.inverse_sigma2 = infinity;
  observations[3].point_in_world *= 1e300;
  observations[4].keypoint.inverse_depth = infinity;
  observations[5].point_in_world = kTruth.Inverse() * Eigen::Vector3d(1, 1, 0);
  observations[6].point_in_world = kTruth.Inverse() * Eigen::Vector3d(1, 1, 1e-300);
  const PoseResult result = OptimizePose(TestCamera(), Start(0.02), observations);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.inliers, 43);
  EXPECT_LT(DistanceFromTruth(result.camera_from_world), 1e-9);
  EXPECT_TRUE(result.information.allFinite());
}

TEST(OptimizePose, SurvivesAStartThatIsNotANumber) {
  Rigid3 start = kTruth;
  start.translation.x() = std::nan("");
  const PoseResult result = OptimizePose(TestCamera(), start, Scene(30, 0, 0));
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.inliers, 0);
}

TEST(OptimizePose, IsDeterministic) {
  const std::vector<PoseObservation> observations = Scene(301, 0.7, 60);
  const PoseResult a = OptimizePose(TestCamera(), Start(0.05), observations);
  const PoseResult b = OptimizePose(TestCamera(), Start(0.05), observations);
  ExpectSameBytes(a.camera_from_world, b.camera_from_world);
  EXPECT_EQ(a.inlier, b.inlier);
  EXPECT_EQ(a.information, b.information);
}

PosePrior Around(const Rigid3& camera_from_world, double sigma) {
  return {camera_from_world, Eigen::Matrix<double, 6, 6>::Identity() / (sigma * sigma)};
}

TEST(OptimizePose, ManyObservationsOverruleAPrior) {
  const PosePrior prior = Around(Start(0.02), 0.02);
  const PoseResult result = OptimizePose(TestCamera(), Start(0.02), Scene(300, 0.5, 0), {}, &prior);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(DistanceFromTruth(result.camera_from_world), 0.005);
}

TEST(OptimizePose, APriorHoldsWhatObservationsLeaveFree) {
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 10; ++i) {  // along a line: free to turn about it
    observations.push_back(Observe(kTruth, {-0.5 + 0.1 * i, 0.2, 2}, true));
  }
  const PosePrior prior = Around(kTruth, 0.01);
  const PoseResult result = OptimizePose(TestCamera(), Start(0.01), observations, {}, &prior);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.inliers, 10);
  EXPECT_LT(DistanceFromTruth(result.camera_from_world), 1e-4);
}

TEST(OptimizePose, PriorAndObservationsShareWhatTheySay) {
  // One observation on the axis, weighted as much as the prior: half way between them.
  PoseObservation observation = Observe({}, {0, 0, 2}, true);
  observation.keypoint.inverse_sigma2 = 1;
  std::vector<PoseObservation> observations(3, observation);
  PosePrior prior = Around({}, 1e-6);  // rigid but for a shift along x
  prior.camera_from_world.translation.x() = 1e-3;
  prior.information(0, 0) = 3 * 525.0 * 525.0 / 4;  // three observations, (f / z)^2
  const PoseResult result = OptimizePose(TestCamera(), prior.camera_from_world, observations, {}, &prior);
  EXPECT_NEAR(result.camera_from_world.translation.x(), 0.5e-3, 1e-5);
}

TEST(OptimizePose, RejectsOptionsWithoutRounds) {
  PoseOptimizerOptions options;
  options.rounds = 0;
  EXPECT_THROW((void)OptimizePose(TestCamera(), kTruth, Scene(10, 0, 0), options), InvariantError);
}

}  // namespace
}  // namespace rds
