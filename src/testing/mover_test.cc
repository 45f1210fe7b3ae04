#include "testing/mover.h"

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

TEST(Mover, WalksWithoutJumps) {
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

}  // namespace
}  // namespace rds::synthetic
