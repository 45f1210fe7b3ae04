// SPDX-License-Identifier: Apache-2.0
#include "eval/evaluation.h"

#include <gmock/gmock.h>

#include <cmath>

#include "testing/matchers.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kRate = 30;

Trajectory Truth(int count) {
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    const double t = i / kRate;
    trajectory.push_back({t, {ExpSo3({0.2 * t, std::sin(t), 0.5 * t}), {std::sin(t), std::cos(2 * t), 0.3 * t}}});
  }
  return trajectory;
}

// The same path seen from another world, `scale` times as large.
Trajectory Moved(Trajectory trajectory, double scale = 1) {
  const Rigid3 world{ExpSo3({1, -2, 0.5}), {3, 4, -5}};
  for (StampedPose& pose : trajectory) {
    pose.world_from_camera.translation *= scale;
    pose.world_from_camera = world * pose.world_from_camera;
  }
  return trajectory;
}

TEST(Evaluate, IsZeroForTheSamePathInAnotherWorld) {
  const Evaluation e = Evaluate(Moved(Truth(100)), Truth(100));
  EXPECT_EQ(e.ate_m.count, 100U);
  EXPECT_LT(e.ate_m.max, 1e-9);
  EXPECT_EQ(e.rpe_translation_m.count, 70U);
  EXPECT_LT(e.rpe_translation_m.max, 1e-9);
  EXPECT_LT(e.rpe_rotation_deg.max, 1e-5);
  EXPECT_THAT(e.matches[50].estimate, RigidNear(e.matches[50].ground_truth, 1e-9, 1e-5));
}

TEST(Evaluate, FindsTheScaleOnlyIfAsked) {
  EvaluationOptions options;
  EXPECT_GT(Evaluate(Moved(Truth(100), 0.8), Truth(100), options).ate_m.rmse, 0.05);
  options.with_scale = true;
  const Evaluation e = Evaluate(Moved(Truth(100), 0.8), Truth(100), options);
  EXPECT_NEAR(e.ground_truth_from_estimate.scale, 1.25, 1e-9);
  EXPECT_LT(e.ate_m.max, 1e-9);
  EXPECT_LT(e.rpe_translation_m.max, 1e-9);
}

// A path that is right but for one jump of 0.3 m across the path and one turn of 10 degrees.
TEST(Evaluate, MeasuresAJumpAndATurn) {
  Trajectory truth;
  for (int i = 0; i < 100; ++i) {
    truth.push_back({i / 10.0, {Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}}});
  }
  Trajectory estimate = truth;
  for (std::size_t i = 50; i < 100; ++i) {
    estimate[i].world_from_camera.translation.z() = 0.3;
    estimate[i].world_from_camera.rotation = ExpSo3({0, 0, 10 * std::acos(-1) / 180});
  }
  const Evaluation e = Evaluate(estimate, truth);
  EXPECT_EQ(e.rpe_translation_m.count, 90U);
  EXPECT_NEAR(e.rpe_translation_m.max, 0.3, 1e-9);
  EXPECT_NEAR(e.rpe_rotation_deg.max, 10, 1e-9);
  // Ten pairs reach over the jump, the others are right; those after the turn move askew by 10 degrees.
  EXPECT_NEAR(e.rpe_rotation_deg.mean, 10.0 * 10 / 90, 1e-9);
}

TEST(Evaluate, PairsByFrames) {
  EvaluationOptions options;
  options.delta_unit = DeltaUnit::kFrames;
  options.delta = 40;
  EXPECT_EQ(Evaluate(Truth(100), Truth(100), options).rpe_translation_m.count, 60U);
  options.delta = 100;
  EXPECT_EQ(Evaluate(Truth(100), Truth(100), options).rpe_translation_m.count, 0U);
  options.delta = 1e300;
  EXPECT_EQ(Evaluate(Truth(100), Truth(100), options).rpe_translation_m.count, 0U);
}

TEST(Evaluate, PairsBySecondsLeaveGapsOut) {
  Trajectory estimate = Truth(150);
  estimate.erase(estimate.begin() + 60, estimate.begin() + 90);  // a second is lost: 2.00 s to 2.97 s
  const Evaluation e = Evaluate(estimate, Truth(150));
  // Of the 120 poses left, 0 - 29 reach a pose before the gap, 60 - 89 are lost, 90 - 119 reach one after it.
  EXPECT_EQ(e.rpe_translation_m.count, 60U);
  EXPECT_LT(e.rpe_translation_m.max, 1e-9);
}

TEST(Evaluate, RefusesWhatCannotBeCompared) {
  Trajectory later = Truth(10);
  for (StampedPose& pose : later) {
    pose.timestamp_s += 1000;
  }
  EXPECT_THAT(InputErrorOf([&] { (void)Evaluate(later, Truth(10)); }),
              AllOf(HasSubstr("only 0 of the estimate's 10 poses match"), HasSubstr("1000.000 to 1000.300 s")));
  EXPECT_THAT(InputErrorOf([&] { (void)Evaluate({}, Truth(10)); }), HasSubstr("covers no time at all"));
  EXPECT_THAT(InputErrorOf([&] { (void)Evaluate(Truth(2), Truth(10)); }), HasSubstr("only 2 of"));
  EvaluationOptions options;
  options.delta = 0;
  EXPECT_THAT(InputErrorOf([&] { (void)Evaluate(Truth(10), Truth(10), options); }), HasSubstr("more than 0"));
  options.delta = 1.5;
  options.delta_unit = DeltaUnit::kFrames;
  EXPECT_THAT(InputErrorOf([&] { (void)Evaluate(Truth(10), Truth(10), options); }), HasSubstr("whole number"));
  options = {};
  options.max_difference_s = std::nan("");
  EXPECT_THAT(InputErrorOf([&] { (void)Evaluate(Truth(10), Truth(10), options); }), HasSubstr("0 or more"));
}

TEST(Evaluate, StandsACameraThatDoesNotMove) {
  Trajectory still = Truth(50);
  for (StampedPose& pose : still) {
    pose.world_from_camera = {};
  }
  for (const bool with_scale : {false, true}) {
    EvaluationOptions options;
    options.with_scale = with_scale;
    const Evaluation e = Evaluate(still, Truth(50), options);
    EXPECT_TRUE(std::isfinite(e.ate_m.rmse));
    EXPECT_GT(e.ate_m.rmse, 0.1);
  }
}

}  // namespace
}  // namespace rds
