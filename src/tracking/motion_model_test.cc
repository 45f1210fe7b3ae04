// SPDX-License-Identifier: Apache-2.0
#include "tracking/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rds {
namespace {

constexpr double kFrame_s = 1.0 / 30;
const Rigid3 kStep{ExpSo3({0.02, -0.01, 0.03}), {0.01, 0.02, -0.01}};

TEST(MotionModel, ExpectsNothingBeforeItSawAMotion) {
  MotionModel motion({});
  EXPECT_FALSE(motion.Predict(kFrame_s));
  EXPECT_FALSE(motion.Prior({}, kFrame_s));
  motion.Observe(kStep, kFrame_s);
  EXPECT_TRUE(motion.Predict(kFrame_s));
  motion.Forget();
  EXPECT_FALSE(motion.Predict(kFrame_s));
}

TEST(MotionModel, GoesOnAsFastAsBefore) {
  MotionModel motion({});
  motion.Observe(kStep, kFrame_s);
  const Rigid3 same = *motion.Predict(kFrame_s);
  EXPECT_LT((same.translation - kStep.translation).norm(), 1e-12);
  EXPECT_LT(AngleOf(same.rotation * kStep.rotation.conjugate()), 1e-7);
  const Rigid3 twice = *motion.Predict(2 * kFrame_s);  // a frame is missing
  EXPECT_LT((twice.translation - 2 * kStep.translation).norm(), 1e-12);
  EXPECT_NEAR(AngleOf(twice.rotation), 2 * AngleOf(kStep.rotation), 1e-9);
}

TEST(MotionModel, AveragesTheLastSteps) {
  MotionModel motion({});
  motion.Observe(kStep, kFrame_s);
  motion.Observe({}, kFrame_s);  // a jolt, or noise
  EXPECT_LT((motion.Predict(kFrame_s)->translation - 0.5 * kStep.translation).norm(), 1e-12);
  for (int i = 0; i < 50; ++i) {
    motion.Observe({}, kFrame_s);
  }
  EXPECT_LT(motion.Predict(kFrame_s)->translation.norm(), 1e-6);
}

TEST(MotionModel, NothingIsLearntFromStepsWithoutTime) {
  MotionModel motion({});
  motion.Observe(kStep, 0);
  EXPECT_FALSE(motion.Predict(kFrame_s));
  motion.Observe(kStep, kFrame_s);
  EXPECT_FALSE(motion.Prior({}, 0));
}

TEST(MotionModel, ThePriorIsWhatAccelerationsAllowButNotTighterThanPosesAre) {
  MotionModel motion({.acceleration_m_s2 = 9, .angular_acceleration_rad_s2 = 18});
  motion.Observe(kStep, kFrame_s);
  const PosePrior prior = *motion.Prior(kStep, kFrame_s);
  EXPECT_EQ(prior.camera_from_world.translation, kStep.translation);
  EXPECT_NEAR(1 / std::sqrt(prior.information(0, 0)), std::hypot(0.01, 0.002), 1e-9);
  EXPECT_NEAR(1 / std::sqrt(prior.information(5, 5)), std::hypot(0.02, 0.003), 1e-9);
  EXPECT_EQ(prior.information(0, 1), 0);
  EXPECT_NEAR(1 / std::sqrt(motion.Prior(kStep, 1e-4)->information(0, 0)), 0.002, 1e-6);
  EXPECT_GT(1 / std::sqrt(motion.Prior(kStep, 1)->information(0, 0)), 9);
}

TEST(MotionModel, NoAccelerationMeansNoPrior) {
  MotionModel motion({.acceleration_m_s2 = 0, .angular_acceleration_rad_s2 = 1});
  motion.Observe(kStep, kFrame_s);
  EXPECT_TRUE(motion.Predict(kFrame_s));
  EXPECT_FALSE(motion.Prior(kStep, kFrame_s));
}

}  // namespace
}  // namespace rds
