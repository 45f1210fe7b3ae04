// SPDX-License-Identifier: Apache-2.0
#include "optim/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"

namespace rds {
namespace {

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = 525;
  camera.fy = 520;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

struct Scene {
  BundleProblem problem;
  std::vector<Rigid3> true_poses;
  std::vector<Eigen::Vector3d> true_points;
};

// Cameras on an arc look at a cloud; the first `fixed` ones are exact and fixed. Observations are exact; every fourth
// one has no depth. Every point is seen by all cameras with it in the image.
Scene MakeScene(int poses, int fixed, int points, double pose_error, double point_error, std::uint64_t seed = 1) {
  Random random(seed);
  Scene scene;
  scene.problem.camera = TestCamera();
  for (int i = 0; i < poses; ++i) {
    const double angle = 0.6 * i / poses;
    const Rigid3 pose{ExpSo3({0.02 * std::sin(i), angle, 0.03 * std::cos(i)}),
                      {-angle, 0.02 * std::cos(i), 0.1 * angle}};
    Eigen::Matrix<double, 6, 1> error;
    for (double& value : error) {
      value = random.Gaussian(0, pose_error);
    }
    scene.true_poses.push_back(pose);
    scene.problem.poses.push_back({i < fixed ? pose : Retract(error, pose), i < fixed});
  }
  while (scene.true_points.size() < static_cast<std::size_t>(points)) {
    const Eigen::Vector3d point(random.Uniform(-2, 2), random.Uniform(-1.5, 1.5), random.Uniform(1.5, 4));
    const auto index = static_cast<std::uint32_t>(scene.true_points.size());
    int seen = 0;
    for (std::size_t i = 0; i < scene.true_poses.size(); ++i) {
      const Eigen::Vector3d in_camera = scene.true_poses[i] * point;
      const Eigen::Vector2d pixel = TestCamera().Project(in_camera);
      if (in_camera.z() < 0.3 || pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= 640 || pixel.y() >= 480) {
        continue;
      }
      BundleProblem::Observation observation;
      observation.pose = static_cast<std::uint32_t>(i);
      observation.point = index;
      observation.keypoint.pixel = pixel;
      observation.keypoint.inverse_sigma2 = std::pow(1.2, -2.0 * random.Index(8));
      if ((scene.problem.observations.size()) % 4 != 0) {
        observation.keypoint.inverse_depth = 1 / in_camera.z();
        observation.keypoint.depth_px = 40;
      }
      scene.problem.observations.push_back(observation);
      ++seen;
    }
    if (seen < 2) {
      scene.problem.observations.resize(scene.problem.observations.size() - static_cast<std::size_t>(seen));
      continue;
    }
    scene.true_points.push_back(point);
    scene.problem.points.push_back(
        point + Eigen::Vector3d(random.Gaussian(0, 1), random.Gaussian(0, 1), random.Gaussian(0, 1)) * point_error);
  }
  return scene;
}

double PoseError(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm() + AngleOf(a.rotation * b.rotation.conjugate());
}

double LargestPoseError(const Scene& scene, const BundleResult& result) {
  double largest = 0;
  for (std::size_t i = 0; i < result.poses.size(); ++i) {
    largest = std::max(largest, PoseError(result.poses[i], scene.true_poses[i]));
  }
  return largest;
}

double LargestPointError(const Scene& scene, const BundleResult& result) {
  double largest = 0;
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    largest = std::max(largest, (result.points[i] - scene.true_points[i]).norm());
  }
  return largest;
}

void ExpectSameBytes(const Rigid3& a, const Rigid3& b) {
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

// Half the robust (or plain) sum of squares, written down once more.
double Cost(const BundleProblem& problem, const std::vector<Rigid3>& poses,
            const std::vector<Eigen::Vector3d>& points) {
  double cost = 0;
  for (const BundleProblem::Observation& observation : problem.observations) {
    const PixelObservation& keypoint = observation.keypoint;
    const Eigen::Vector3d in_camera = poses[observation.pose] * points[observation.point];
    const Eigen::Vector2d projected = problem.camera.Project(in_camera);
    double squared = (keypoint.pixel - projected).squaredNorm();
    if (keypoint.HasDepth()) {
      squared += std::pow(keypoint.depth_px * (keypoint.inverse_depth - 1 / in_camera.z()), 2);
    }
    const double norm = keypoint.weight * std::sqrt(keypoint.inverse_sigma2 * squared);
    const double huber = keypoint.HasDepth() ? BundleOptions().huber_depth : BundleOptions().huber_mono;
    cost += 0.5 * (norm <= huber ? norm * norm : huber * (2 * norm - huber));
  }
  return cost;
}

std::vector<Rigid3> InitialPoses(const BundleProblem& problem) {
  std::vector<Rigid3> poses;
  for (const BundleProblem::Pose& pose : problem.poses) {
    poses.push_back(pose.camera_from_world);
  }
  return poses;
}

TEST(AdjustBundle, RecoversAPerturbedScene) {
  const Scene scene = MakeScene(8, 2, 150, 0.02, 0.03);
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_TRUE(result.usable);
  EXPECT_LT(LargestPoseError(scene, result), 1e-6);
  EXPECT_LT(LargestPointError(scene, result), 1e-6);
  EXPECT_EQ(std::count(result.outlier.begin(), result.outlier.end(), 1), 0);
  EXPECT_NEAR(result.initial_cost, Cost(scene.problem, InitialPoses(scene.problem), scene.problem.points),
              1e-9 * result.initial_cost);
  EXPECT_LT(result.final_cost, 1e-9 * result.initial_cost);
  EXPECT_GT(result.iterations, 0);
}

TEST(AdjustBundle, RecoversASceneWithManyFreePoses) {
  const Scene scene = MakeScene(80, 2, 400, 0.01, 0.02);
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_LT(LargestPoseError(scene, result), 1e-6);
  EXPECT_LT(LargestPointError(scene, result), 1e-6);
}

TEST(AdjustBundle, RefinesPointsAloneIfAllPosesAreFixed) {
  const Scene scene = MakeScene(4, 4, 50, 0, 0.03);
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_TRUE(result.usable);
  EXPECT_LT(LargestPointError(scene, result), 1e-6);
}

TEST(AdjustBundle, KeepsFixedPosesToTheByte) {
  Scene scene = MakeScene(6, 3, 80, 0.02, 0.03);
  scene.problem.poses[1].camera_from_world.rotation.coeffs() *= 1 + 1e-13;  // not quite normalized
  const BundleResult result = AdjustBundle(scene.problem);
  for (std::size_t i = 0; i < 3; ++i) {
    ExpectSameBytes(result.poses[i], scene.problem.poses[i].camera_from_world);
  }
  EXPECT_GT(PoseError(result.poses[4], scene.problem.poses[4].camera_from_world), 1e-3);
}

TEST(AdjustBundle, HoldsTheFirstPoseIfNoneIsFixed) {
  Scene scene = MakeScene(5, 1, 80, 0.02, 0.03);
  scene.problem.poses[0].fixed = false;
  const BundleResult result = AdjustBundle(scene.problem);
  ExpectSameBytes(result.poses[0], scene.problem.poses[0].camera_from_world);
  EXPECT_LT(LargestPoseError(scene, result), 1e-6);
}

TEST(AdjustBundle, FlagsOutliersAndIsNotDrawnByThem) {
  Scene scene = MakeScene(8, 2, 200, 0.01, 0.01);
  std::vector<std::uint8_t> expected(scene.problem.observations.size());
  for (std::size_t i = 3; i < expected.size(); i += 20) {
    expected[i] = 1;
    scene.problem.observations[i].keypoint.pixel += Eigen::Vector2d(25, -35);
  }
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_EQ(result.outlier, expected);
  EXPECT_LT(LargestPoseError(scene, result), 1e-6);
}

TEST(AdjustBundle, WithoutTheFinalStageTheKernelStaysOn) {
  Scene scene = MakeScene(6, 2, 100, 0.01, 0.01);
  for (std::size_t i = 0; i < scene.problem.observations.size(); i += 10) {
    scene.problem.observations[i].keypoint.pixel += Eigen::Vector2d(9, -5);
  }
  BundleOptions options;
  options.robust_iterations = 20;
  options.final_iterations = 0;
  const BundleResult result = AdjustBundle(scene.problem, options);
  EXPECT_NEAR(result.final_cost, Cost(scene.problem, result.poses, result.points), 1e-9 * result.final_cost);
  EXPECT_LT(result.final_cost, Cost(scene.problem, scene.true_poses, scene.true_points));
}

TEST(AdjustBundle, WeightsScaleTheResiduals) {
  // A pixel that two depth observations of one point from fixed cameras disagree about: the point settles at the mean
  // weighted with weight^2.
  BundleProblem problem;
  problem.camera = TestCamera();
  problem.poses.push_back({Rigid3{}, true});
  problem.points.emplace_back(0, 0, 2);
  for (const double shift_px : {0.0, 0.5}) {
    BundleProblem::Observation observation;
    observation.keypoint.pixel = TestCamera().Project(problem.points[0]) + Eigen::Vector2d(0, shift_px);
    observation.keypoint.inverse_depth = 0.5;
    observation.keypoint.depth_px = 40;
    observation.keypoint.weight = shift_px == 0 ? 1.0 : 0.5;
    problem.observations.push_back(observation);
  }
  const BundleResult result = AdjustBundle(problem);
  const Eigen::Vector2d pixel = TestCamera().Project(result.points[0]);
  EXPECT_NEAR(pixel.y() - problem.observations[0].keypoint.pixel.y(), 0.5 * 0.25 / 1.25, 2e-5);
}

TEST(AdjustBundle, ZeroWeightHasNoInfluence) {
  Scene scene = MakeScene(6, 2, 100, 0.01, 0.01);
  BundleProblem without = scene.problem;
  std::erase_if(without.observations,
                [](const BundleProblem::Observation& o) { return o.point % 7 == 3 && o.pose == 4; });
  for (BundleProblem::Observation& observation : scene.problem.observations) {
    if (observation.point % 7 == 3 && observation.pose == 4) {
      observation.keypoint.weight = 0;
      observation.keypoint.pixel.x() += 1.5;
    }
  }
  const BundleResult a = AdjustBundle(scene.problem);
  const BundleResult b = AdjustBundle(without);
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    ExpectSameBytes(a.poses[i], b.poses[i]);
  }
}

TEST(AdjustBundle, PointsSeenOnceAreLegal) {
  Scene scene = MakeScene(5, 2, 80, 0.01, 0.02);
  auto& observations = scene.problem.observations;
  // Of point 0 keep one observation with depth, of point 1 one without, of point 2 none.
  std::vector<int> kept(3);
  std::erase_if(observations, [&](const BundleProblem::Observation& observation) {
    if (observation.point > 2) {
      return false;
    }
    const bool wanted = observation.point < 2 && observation.keypoint.HasDepth() == (observation.point == 0);
    return !wanted || kept[observation.point]++ > 0;
  });
  ASSERT_GT(kept[0], 0);
  ASSERT_GT(kept[1], 0);
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_TRUE(result.usable);
  EXPECT_LT(LargestPoseError(scene, result), 1e-6);
  EXPECT_LT((result.points[0] - scene.true_points[0]).norm(), 1e-6);
  EXPECT_TRUE(result.points[1].allFinite());
  EXPECT_LT((result.points[1] - scene.true_points[1]).norm(), 0.2);  // somewhere on its ray, near where it was
  EXPECT_EQ(result.points[2], scene.problem.points[2]);
}

TEST(AdjustBundle, PosesWithoutObservationsStay) {
  Scene scene = MakeScene(5, 2, 80, 0.01, 0.02);
  std::erase_if(scene.problem.observations, [](const BundleProblem::Observation& o) { return o.pose == 3; });
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_TRUE(result.usable);
  ExpectSameBytes(result.poses[3], scene.problem.poses[3].camera_from_world);
  EXPECT_LT(PoseError(result.poses[4], scene.true_poses[4]), 1e-6);
}

TEST(AdjustBundle, NothingToDoIsNotUsable) {
  EXPECT_FALSE(AdjustBundle({}).usable);
  Scene scene = MakeScene(3, 1, 10, 0.01, 0.01);
  scene.problem.observations.clear();
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_FALSE(result.usable);
  EXPECT_EQ(result.points, scene.problem.points);
  ASSERT_EQ(result.poses.size(), 3U);
  ExpectSameBytes(result.poses[2], scene.problem.poses[2].camera_from_world);
}

TEST(AdjustBundle, PointsBehindTheCameraAndNonsenseAreOutliers) {
  Scene scene = MakeScene(6, 2, 100, 0.01, 0.01);
  const double nan = std::nan("");
  scene.problem.points[5].z() = -3;
  scene.problem.points[6].x() = nan;
  auto& odd = scene.problem.observations.back();
  odd.keypoint.pixel.y() = nan;
  const BundleResult result = AdjustBundle(scene.problem);
  EXPECT_TRUE(result.usable);
  EXPECT_LT(LargestPoseError(scene, result), 1e-6);
  EXPECT_EQ(result.points[5], scene.problem.points[5]);
  for (std::size_t i = 0; i + 1 < scene.problem.observations.size(); ++i) {
    const std::uint32_t point = scene.problem.observations[i].point;
    EXPECT_EQ(result.outlier[i], point == 5 || point == 6 ? 1 : 0);
  }
  EXPECT_EQ(result.outlier.back(), 1);
}

TEST(AdjustBundle, StopsEarlyWithTheBestState) {
  const Scene scene = MakeScene(8, 2, 150, 0.05, 0.1);
  double previous = Cost(scene.problem, InitialPoses(scene.problem), scene.problem.points);
  for (const int polls_before_stop : {2, 3, 4}) {
    int polls = 0;
    const BundleResult result = AdjustBundle(scene.problem, {}, [&] { return ++polls >= polls_before_stop; });
    EXPECT_TRUE(result.usable);
    EXPECT_EQ(polls, polls_before_stop);
    EXPECT_EQ(result.iterations, polls_before_stop - 1);
    const double cost = Cost(scene.problem, result.poses, result.points);
    EXPECT_LT(cost, previous);
    EXPECT_NEAR(cost, result.final_cost, 1e-9 * cost);
    previous = cost;
  }
}

TEST(AdjustBundle, NeverEndsWorseThanItBegan) {  // far off, where first steps go astray and must be taken back
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = MakeScene(5, 1, 40, 0.3, 1.0, seed);
    for (int iterations = 1; iterations <= 3; ++iterations) {
      BundleOptions options;
      options.robust_iterations = iterations;
      options.final_iterations = 0;
      const BundleResult result = AdjustBundle(scene.problem, options);
      EXPECT_LE(result.final_cost, result.initial_cost);
      BundleProblem used = scene.problem;  // without what began behind a camera
      const std::vector<Rigid3> poses = InitialPoses(scene.problem);
      std::erase_if(used.observations, [&](const BundleProblem::Observation& observation) {
        return (poses[observation.pose] * scene.problem.points[observation.point]).z() <= 0;
      });
      EXPECT_NEAR(Cost(used, result.poses, result.points), result.final_cost, 1e-6 * result.final_cost);
    }
  }
}

TEST(AdjustBundle, StoppedAtOnceIsNotUsableAndChangesNothing) {
  const Scene scene = MakeScene(8, 2, 150, 0.05, 0.1);
  const BundleResult result = AdjustBundle(scene.problem, {}, [] { return true; });
  EXPECT_FALSE(result.usable);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.points, scene.problem.points);
  for (std::size_t i = 0; i < result.poses.size(); ++i) {
    ExpectSameBytes(result.poses[i], scene.problem.poses[i].camera_from_world);
  }
}

TEST(AdjustBundle, IsDeterministic) {
  Scene scene = MakeScene(8, 2, 150, 0.03, 0.05);
  for (std::size_t i = 0; i < scene.problem.observations.size(); i += 9) {
    scene.problem.observations[i].keypoint.pixel += Eigen::Vector2d(1.5, 20);
  }
  const BundleResult a = AdjustBundle(scene.problem);
  const std::vector<char> other_addresses(12345);
  const BundleResult b = AdjustBundle(scene.problem);
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    ExpectSameBytes(a.poses[i], b.poses[i]);
  }
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.outlier, b.outlier);
  EXPECT_EQ(a.final_cost, b.final_cost);
}

TEST(AdjustBundle, SaysNothing) {
  Scene scene = MakeScene(4, 1, 30, 0.02, 0.03);
  scene.problem.points[3] = scene.true_poses[1].Inverse() * Eigen::Vector3d(0, 0, 1e-5);
  scene.problem.camera.fx = 1e7;  // a hopeless problem
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  (void)AdjustBundle(scene.problem);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(AdjustBundle, RejectsIndicesOutOfRange) {
  Scene scene = MakeScene(3, 1, 10, 0, 0);
  scene.problem.observations[4].pose = 3;
  EXPECT_THROW((void)AdjustBundle(scene.problem), InvariantError);
  scene.problem.observations[4].pose = 0;
  scene.problem.observations[4].point = 10;
  EXPECT_THROW((void)AdjustBundle(scene.problem), InvariantError);
}

}  // namespace
}  // namespace rds
