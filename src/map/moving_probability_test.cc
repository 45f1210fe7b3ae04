// SPDX-License-Identifier: Apache-2.0
#include "map/moving_probability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace rds {
namespace {

TEST(MovingProbability, BayesStepHasTheProperNormalizer) {
  MovingProbabilityOptions options;
  options.floor = 0;
  EXPECT_DOUBLE_EQ(UpdateProbability(0.5, true, options), 0.9);
  EXPECT_DOUBLE_EQ(UpdateProbability(0.5, false, options), 0.1);
  EXPECT_NEAR(UpdateProbability(0.9, true, options), 0.81 / 0.82, 1e-12);
  EXPECT_NEAR(UpdateProbability(UpdateProbability(0.3, true, options), false, options), 0.3, 1e-12);
}

TEST(MovingProbability, StaysWithinItsFloorSoThatAPointCanChangeItsMind) {
  const MovingProbabilityOptions options;
  double p = 0.5;
  for (int i = 0; i < 100; ++i) {
    p = UpdateProbability(p, true, options);
  }
  EXPECT_DOUBLE_EQ(p, 1.0 - options.floor);
  for (int i = 0; i < 4; ++i) {
    p = UpdateProbability(p, false, options);
  }
  EXPECT_EQ(StateOf(p, options), PointState::kStatic);
}

TEST(MovingProbability, ThresholdsBelongToUnknown) {
  const MovingProbabilityOptions options;
  EXPECT_EQ(StateOf(0.39, options), PointState::kStatic);
  EXPECT_EQ(StateOf(0.4, options), PointState::kUnknown);
  EXPECT_EQ(StateOf(0.6, options), PointState::kUnknown);
  EXPECT_EQ(StateOf(0.61, options), PointState::kDynamic);
}

TEST(MovingProbability, FusingJoinsTheEvidence) {
  const MovingProbabilityOptions options;
  EXPECT_NEAR(FuseProbabilities(0.5, 0.8, options), 0.8, 1e-12);
  EXPECT_NEAR(FuseProbabilities(0.1, 0.9, options), 0.5, 1e-12);
  EXPECT_NEAR(FuseProbabilities(0.8, 0.8, options), 0.64 / 0.68, 1e-12);
}

TEST(MovingProbabilities, UnsetPointsAreUnknownAndBlocksGrow) {
  MovingProbabilities table;
  EXPECT_EQ(table.Get(PointId{123456}), kUnknownProbability);
  EXPECT_EQ(table.Get(PointId{}), kUnknownProbability);
  table.Set(PointId{123456}, 0.25);
  EXPECT_EQ(table.Get(PointId{123456}), 0.25);
  EXPECT_EQ(table.Get(PointId{123457}), kUnknownProbability);
  EXPECT_NEAR(table.Observe(PointId{7}, true), std::log(9), 1e-5);
  EXPECT_NEAR(table.Get(PointId{7}), 0.9, 1e-6);
  EXPECT_EQ(table.State(PointId{7}), PointState::kDynamic);
  table.Retract(PointId{7}, static_cast<float>(std::log(9)));
  EXPECT_NEAR(table.Get(PointId{7}), kUnknownProbability, 1e-6);
}

TEST(MovingProbabilities, ReleasedPagesAreForgottenInAWhileAndServeAgain) {
  MovingProbabilities table({}, 4);
  table.Set(PointId{3}, 0.25);
  const std::vector<std::uint32_t> first = {0};
  table.Release(first);
  for (int i = 1; i < MovingProbabilities::kPatience; ++i) {
    table.Release({});
    ASSERT_EQ(table.Get(PointId{3}), 0.25) << "old snapshots still ask";
  }
  table.Release({});
  EXPECT_EQ(table.Get(PointId{3}), kUnknownProbability);
  // A day in which each page lives for a while: memory stays.
  for (std::uint32_t page = 4; page < 40'000; ++page) {
    const PointId point{static_cast<std::uint32_t>(page * kIdsPerPage + 5)};
    ASSERT_EQ(table.Get(point), kUnknownProbability);
    table.Set(point, 0.75);
    ASSERT_EQ(table.Get(point), 0.75);
    const std::vector<std::uint32_t> dead = {page};
    table.Release(dead);
  }
  EXPECT_LE(table.pages_made(), 4U);
}

}  // namespace
}  // namespace rds
