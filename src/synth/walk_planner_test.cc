// SPDX-License-Identifier: Apache-2.0
#include "synth/walk_planner.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rds::synthetic {
namespace {

constexpr double kDuration_s = 20;

const Room& TheRoom() {
  static const Room room = BuildRoom(1, 8.0);  // coarse pictures: only the layout matters here
  return room;
}

class EveryMotion : public testing::TestWithParam<SyntheticPath> {};

TEST_P(EveryMotion, CameraIsSmoothAndModerate) {
  const CameraPath path(GetParam(), 3);
  double fastest_m = 0;
  double fastest_deg = 0;
  for (int i = 1; i < 900; ++i) {
    const Rigid3 step = path.WorldFromCamera((i - 1) / 30.0).Inverse() * path.WorldFromCamera(i / 30.0);
    fastest_m = std::max(fastest_m, step.translation.norm() * 30);
    fastest_deg = std::max(fastest_deg, AngleOf(step.rotation) * 30 * 180 / M_PI);
  }
  EXPECT_LT(fastest_m, 0.75);
  EXPECT_LT(fastest_deg, 45);
  EXPECT_GT(fastest_deg, 0.1);  // never frozen
}

TEST_P(EveryMotion, CameraKeepsClearOfTheRoom) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const CameraPath path(GetParam(), seed);
    for (int i = 0; i < 400; ++i) {
      ASSERT_GT(TheRoom().Clearance(path.WorldFromCamera(i / 10.0).translation), 0.2) << i;
    }
  }
}

TEST_P(EveryMotion, PeopleKeepClearOfCameraFurnitureAndEachOther) {
  const CameraPath path(GetParam(), 1);
  for (const SyntheticScenario scenario :
       {SyntheticScenario::kWalking, SyntheticScenario::kSitting, SyntheticScenario::kCrossing}) {
    const bool sits = scenario == SyntheticScenario::kSitting;
    const std::vector<Mover> movers = PlanMovers(scenario, 2, TheRoom(), path, kDuration_s, 5);
    ASSERT_EQ(movers.size(), 2U);
    for (double t = 0; t < kDuration_s; t += 0.1) {
      const Eigen::Vector3d camera = path.WorldFromCamera(t).translation;
      EXPECT_GT((movers[0].PlaceAt(t) - movers[1].PlaceAt(t)).norm(), 0.45) << NameOf(scenario) << " at " << t;
      for (const Mover& mover : movers) {
        if (!sits) {
          EXPECT_GT(TheRoom().FloorClearance(mover.PlaceAt(t)), 0.2) << NameOf(scenario) << " at " << t;
        }
        for (const Capsule& part : mover.At(t)) {
          EXPECT_GT(Distance(part, camera), 0.2) << NameOf(scenario) << " at " << t;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, EveryMotion,
                         testing::Values(SyntheticPath::kOrbit, SyntheticPath::kLoop, SyntheticPath::kXyz,
                                         SyntheticPath::kRpy, SyntheticPath::kHalfsphere, SyntheticPath::kStatic),
                         [](const auto& the) { return std::string(NameOf(the.param)); });

TEST(PlanMovers, WalksHaveNoJumps) {
  const CameraPath path(SyntheticPath::kOrbit, 1);
  const std::vector<Mover> movers = PlanMovers(SyntheticScenario::kWalking, 3, TheRoom(), path, kDuration_s, 9);
  for (const Mover& mover : movers) {
    double walked = 0;
    for (double t = 0.02; t < kDuration_s; t += 0.02) {
      const double step = (mover.PlaceAt(t) - mover.PlaceAt(t - 0.02)).norm();
      ASSERT_LT(step, 0.02 * 1.3);
      walked += step;
    }
    EXPECT_GT(walked, 0.3 * kDuration_s);
  }
}

// Stands and goes, near enough to fill much of the picture.
TEST(PlanMovers, ThoseWhoWalkTogetherStayAbreast) {
  const CameraPath path(SyntheticPath::kOrbit, 1);
  const std::vector<Mover> movers = PlanMovers(SyntheticScenario::kWalking, 3, TheRoom(), path, kDuration_s, 1);
  const Eigen::Vector2d offset = movers[1].PlaceAt(0) - movers[0].PlaceAt(0);
  int still = 0;
  int near = 0;
  constexpr int kSteps = 100;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 0.1 * i;
    EXPECT_LT((movers[1].PlaceAt(t) - movers[0].PlaceAt(t) - offset).norm(), 1e-9);
    EXPECT_LT((movers[2].PlaceAt(t) - movers[1].PlaceAt(t) - offset).norm(), 1e-9);
    still += (movers[0].PlaceAt(t + 0.1) - movers[0].PlaceAt(t)).norm() < 1e-9 ? 1 : 0;
    const Rigid3 world_from_camera = path.WorldFromCamera(t);
    for (const Mover& mover : movers) {
      near += (mover.PlaceAt(t) - world_from_camera.translation.head<2>()).norm() < 1.2 ? 1 : 0;
    }
  }
  EXPECT_LT(offset.norm(), 0.7);
  EXPECT_GT(still, 0.2 * kSteps);
  EXPECT_LT(still, 0.8 * kSteps);
  EXPECT_GT(near, kSteps);  // of three in each step
}

// However long the sequence is, it begins in the same way.
TEST(PlanMovers, LongerSequencesGoOnWhereShorterOnesEnd) {
  const CameraPath path(SyntheticPath::kOrbit, 1);
  const std::vector<Mover> shorter = PlanMovers(SyntheticScenario::kWalking, 3, TheRoom(), path, 4, 1);
  const std::vector<Mover> longer = PlanMovers(SyntheticScenario::kWalking, 3, TheRoom(), path, 14, 1);
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    EXPECT_EQ(shorter[i].PlaceAt(4), longer[i].PlaceAt(4));
  }
}

}  // namespace
}  // namespace rds::synthetic
