// SPDX-License-Identifier: Apache-2.0
#include "synth/mover.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rds::synthetic {
namespace {

TEST(Mover, SitterFidgetsOnTheSpot) {
  const Mover mover(4, Seat{{1, 0}, 0});
  const std::vector<Capsule> before = mover.At(1.0);
  const std::vector<Capsule> after = mover.At(2.5);
  double most = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    most = std::max(most, (before[i].center - after[i].center).norm());
    EXPECT_LT((after[i].center.head<2>() - Eigen::Vector2d(1, 0)).norm(), 1.0);
  }
  EXPECT_GT(most, 0.05);
  EXPECT_EQ(mover.PlaceAt(0), mover.PlaceAt(7));
}

TEST(Mover, BodyIsAsTallAsAPersonAndStandsOnTheFloor) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Person person(seed);
    double top = 0;
    double bottom = 9;
    for (const Capsule& part : person.Walking({}, 0)) {
      const double reach = std::abs(part.axes(2, 2)) * part.half_length + part.axes.row(2).norm();
      top = std::max(top, part.center.z() + reach);
      bottom = std::min(bottom, part.center.z() - reach);
    }
    EXPECT_GT(top, 1.55);
    EXPECT_LT(top, 2.0);
    EXPECT_NEAR(bottom, 0, 0.06);
  }
}

TEST(Stance, FollowsItsLegs) {
  const std::vector<Leg> legs{
      {0, 0, {0, 0}, {0, 0}, 0, 0}, {1, 3, {0, 0}, {2, 0}, 0, 0}, {4, 5, {2, 0}, {2, 1}, 2, M_PI / 2}};
  EXPECT_EQ(StanceAt(legs, 0.5).position.x(), 0);
  EXPECT_EQ(StanceAt(legs, 0.5).effort, 0);
  EXPECT_NEAR(StanceAt(legs, 2.0).position.x(), 1, 1e-12);
  EXPECT_NEAR(StanceAt(legs, 2.0).distance_m, 1, 1e-12);
  EXPECT_EQ(StanceAt(legs, 2.0).effort, 1);
  EXPECT_NEAR(StanceAt(legs, 3.4).heading, 0, 1e-12);  // turns just before it goes on
  EXPECT_NEAR(StanceAt(legs, 4.0).heading, M_PI / 2, 1e-12);
  EXPECT_NEAR(StanceAt(legs, 9.0).position.y(), 1, 1e-12);
  EXPECT_NEAR(StanceAt(legs, 9.0).distance_m, 3, 1e-12);
}

TEST(Stance, SpeedsUpAndSlowsDownEvenly) {
  const Leg leg{1, 3 + kRamp_s, {0, 0}, {2, 0}, 0, 0};  // 1 m/s at full speed
  EXPECT_EQ(ShareWalked(leg, 0.5), 0);
  EXPECT_NEAR(2 * ShareWalked(leg, 1 + kRamp_s), 0.5 * kRamp_s, 1e-12);
  EXPECT_NEAR(2 * (ShareWalked(leg, 2.3) - ShareWalked(leg, 2.1)), 0.2, 1e-12);
  EXPECT_NEAR(2 * ShareWalked(leg, 3), 2 - 0.5 * kRamp_s, 1e-12);
  EXPECT_NEAR(ShareWalked(leg, 3 + kRamp_s), 1, 1e-12);
  EXPECT_NEAR(ShareWalked(leg, 9), 1, 1e-12);
  const Leg step{0, 0.4, {0, 0}, {0.1, 0}, 0, 0};  // too short for full speed
  EXPECT_NEAR(ShareWalked(step, 0.1), 0.125, 1e-12);
  EXPECT_NEAR(ShareWalked(step, 0.2), 0.5, 1e-12);
  EXPECT_NEAR(ShareWalked(step, 0.4), 1, 1e-12);
}

}  // namespace
}  // namespace rds::synthetic
