// SPDX-License-Identifier: Apache-2.0
#include "synth/building.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "synth/synthetic_world.h"

namespace rds::synthetic {
namespace {

TEST(Building, TheWayIsSmoothAndClosed) {
  EXPECT_NEAR(RingLength(), 61.9, 0.5);
  for (double way_m = -5; way_m < RingLength() + 5; way_m += 0.05) {
    const RingPlace here = RingAt(way_m);
    const RingPlace next = RingAt(way_m + 0.01);
    EXPECT_NEAR((next.position - here.position).norm(), 0.01, 1e-3) << way_m;
    const Eigen::Vector2d heading(std::cos(here.heading), std::sin(here.heading));
    EXPECT_NEAR((next.position - here.position).normalized().dot(heading), 1, 1e-3) << way_m;
  }
  EXPECT_LT((RingAt(RingLength()).position - RingAt(0).position).norm(), 1e-9);
}

TEST(Building, TheCameraStaysInTheCorridorAndComesRound) {
  for (const bool back : {false, true}) {
    for (double time_s = 0; time_s < 90; time_s += 0.1) {
      const Rigid3 pose = RingGaze(time_s, back);
      const RingPlace place = RingAt((back ? -0.8 : 0.8) * time_s);
      EXPECT_LT((pose.translation.head<2>() - place.position).norm(), 0.5);
      EXPECT_NEAR(pose.translation.z(), 1.35, 0.1);
    }
    const double round_s = RingLength() / 0.8;
    EXPECT_LT((RingGaze(round_s, back).translation - RingGaze(0, back).translation).norm(), 0.3);
  }
  // Both pass a place on different sides.
  EXPECT_GT((RingGaze(0, false).translation - RingGaze(0, true).translation).norm(), 0.5);
}

TEST(Building, PeopleWalkTheCorridors) {
  for (const Mover& mover : PlanRingWalkers(4, 60, 3)) {
    for (double time_s = 0; time_s < 60; time_s += 1) {
      const Eigen::Vector2d place = mover.PlaceAt(time_s);
      EXPECT_LT(std::abs(place.x()), 9.2);
      EXPECT_LT(std::abs(place.y()), 7.2);
      EXPECT_TRUE(std::abs(place.x()) > 8 || std::abs(place.y()) > 6);
    }
  }
}

SyntheticOptions Small() {
  SyntheticOptions options;
  options.camera = MakeSyntheticCamera(160, 120);
  options.camera.depth_scale = 1000;  // for 65 m of range
  options.scenario = SyntheticScenario::kBuilding;
  options.path = SyntheticPath::kRing;
  options.frames = 2400;
  options.noise = false;
  return options;
}

TEST(Building, IsClosedAllRound) {
  SyntheticOptions options = Small();
  options.movers = 0;
  const SyntheticWorld world(options);
  for (int index = 0; index < 2400; index += 97) {
    const SyntheticFrame frame = world.Render(index);
    int holes = 0;
    for (const std::uint16_t depth : frame.rgbd.depth->data) {
      holes += depth == 0 ? 1 : 0;
    }
    EXPECT_EQ(holes, 0) << index;
  }
}

TEST(Building, RoomsThatAreAlikeLookTheSame) {
  SyntheticOptions options = Small();
  options.movers = 0;
  const auto deviation = [&](bool alike) {
    options.alike = alike;
    const Room building = BuildBuilding(options.seed, {.alike = alike}, 2);
    // The panels of the rooms' back walls: 3.2 m wide, full height.
    std::vector<const Quad*> backs;
    for (const Quad& quad : building.scene.quads) {
      if (std::abs(quad.width - 3.2) < 1e-9 && std::abs(quad.height - 2.6) < 1e-9) {
        backs.push_back(&quad);
      }
    }
    EXPECT_EQ(backs.size(), 8U);
    double sum = 0;
    for (const Quad* back : backs) {
      for (float x = 5; x < back->texture->width(); x += 7) {
        const Float4 difference = back->texture->Sample(x, 40, 0) - backs[0]->texture->Sample(x, 40, 0);
        sum += static_cast<double>(std::abs(difference[1]));
      }
    }
    return sum;
  };
  EXPECT_EQ(deviation(true), 0);
  EXPECT_GT(deviation(false), 0);
}

TEST(Building, DecoratedAnewKeepsItsWallsAndChangesPicturesAndFurniture) {
  const Room before = BuildBuilding(1, {}, 2.5);
  const Room after = BuildBuilding(1, {.decor = 1}, 2.5);
  ASSERT_EQ(before.scene.quads.size(), after.scene.quads.size());
  int same = 0;
  int changed = 0;
  for (std::size_t i = 0; i < before.scene.quads.size(); ++i) {
    const Quad& a = before.scene.quads[i];
    const Quad& b = after.scene.quads[i];
    const bool is_alike = a.width == b.width && a.height == b.height && a.texture->width() == b.texture->width() &&
                          a.texture->Sample(9.5F, 9.5F, 0)[1] == b.texture->Sample(9.5F, 9.5F, 0)[1] &&
                          a.texture->Sample(20.5F, 30.5F, 0)[0] == b.texture->Sample(20.5F, 30.5F, 0)[0];
    const bool is_wall = std::max(a.width, a.height) > 2.0 && std::min(a.width, a.height) > 1.0;
    same += is_wall && is_alike ? 1 : 0;
    changed += !is_wall && !is_alike ? 1 : 0;
  }
  EXPECT_GT(same, 40);
  EXPECT_GT(changed, 60);
}

TEST(Building, HasPathsOfItsOwn) {
  SyntheticOptions options = Small();
  options.path = SyntheticPath::kOrbit;
  EXPECT_THROW(Validate(options), InputError);
  options = Small();
  options.scenario = SyntheticScenario::kWalking;
  EXPECT_THROW(Validate(options), InputError);
  options = SyntheticOptions{};
  options.alike = true;
  EXPECT_THROW(Validate(options), InputError);
  options = SyntheticOptions{};
  options.decor = 1;
  EXPECT_THROW(Validate(options), InputError);
}

}  // namespace
}  // namespace rds::synthetic
