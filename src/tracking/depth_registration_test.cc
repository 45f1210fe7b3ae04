// SPDX-License-Identifier: Apache-2.0
#include "tracking/depth_registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "base/random.h"
#include "testing/board.h"

namespace rds {
namespace {

struct TestPlane {
  Eigen::Vector3d normal;
  double distance_m;  // normal . point
};

const TestPlane kBackWall{{0, 0, 1}, 2.5};
const std::vector<TestPlane> kCorner = {kBackWall, {{0, 1, 0}, 0.8}, {{1, 0, 0}, 1.1}};

// What TestCamera sees of planes, with noise in standard deviations of a structured-light camera.
std::shared_ptr<const FrameData> SeePlanes(const std::vector<TestPlane>& planes, const Rigid3& camera_from_world,
                                           double noise = 0, std::uint64_t seed = 1) {
  const PinholeCamera camera = TestCamera();
  const Rigid3 world_from_camera = camera_from_world.Inverse();
  Random random(seed);
  std::vector<float> depth_m;
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 0; column < kBoardColumns; ++column) {
      const Eigen::Vector3d ray = world_from_camera.rotation * camera.Unproject({8 * column + 4.0, 8 * row + 4.0}, 1);
      double nearest = std::numeric_limits<double>::max();
      for (const TestPlane& plane : planes) {
        const double depth =
            (plane.distance_m - plane.normal.dot(world_from_camera.translation)) / plane.normal.dot(ray);
        nearest = depth > 0 ? std::min(nearest, depth) : nearest;
      }
      nearest += noise * 0.0015 * nearest * nearest * random.Gaussian(0, 1);
      depth_m.push_back(static_cast<float>(nearest));
    }
  }
  return std::make_shared<const FrameData>(camera, std::vector<Keypoint>{}, std::vector<Descriptor>{},
                                           DepthGrid(kBoardColumns, kBoardRows, std::move(depth_m)));
}

PosePrior Within(const Rigid3& camera_from_world, double meters, double radians) {
  PosePrior prior{camera_from_world, {}};
  prior.information.setZero();
  prior.information.diagonal().head<3>().setConstant(1 / (meters * meters));
  prior.information.diagonal().tail<3>().setConstant(1 / (radians * radians));
  return prior;
}

double DistanceBetween(const Rigid3& a, const Rigid3& b) {
  return (a.Inverse().translation - b.Inverse().translation).norm();
}

double AngleBetween(const Rigid3& a, const Rigid3& b) { return AngleOf(a.rotation * b.rotation.conjugate()); }

const Rigid3 kMoved{ExpSo3({0.01, -0.02, 0.015}), {0.02, -0.01, 0.03}};

TEST(RegisterDepth, FindsHowTheCameraMovedBeforeACorner) {
  const auto view = SeePlanes(kCorner, {});
  const PosePrior prior = Within({}, 0.1, 0.1);
  const PosePrior found = RegisterDepth(*SeePlanes(kCorner, kMoved), {}, *view, {}, prior, {});
  EXPECT_LT(DistanceBetween(found.camera_from_world, kMoved), 0.002);
  EXPECT_LT(AngleBetween(found.camera_from_world, kMoved), 0.001);
  for (int i = 0; i < 6; ++i) {  // every direction is known better than before
    EXPECT_GT(found.information(i, i), 2 * prior.information(i, i)) << i;
  }
}

TEST(RegisterDepth, TakesTheViewWhereItIsInTheWorld) {
  const Rigid3 view_from_world{ExpSo3({0.05, -0.1, -0.02}), {0.1, 0.05, -0.1}};
  const Rigid3 frame_from_world = kMoved * view_from_world;
  const PosePrior found = RegisterDepth(*SeePlanes(kCorner, frame_from_world), {}, *SeePlanes(kCorner, view_from_world),
                                        view_from_world, Within(view_from_world, 0.1, 0.1), {});
  EXPECT_LT(DistanceBetween(found.camera_from_world, frame_from_world), 0.002);
  EXPECT_LT(AngleBetween(found.camera_from_world, frame_from_world), 0.001);
}

TEST(RegisterDepth, SaysNothingAlongAWall) {
  Rigid3 expected;
  expected.translation = {0.02, -0.01, 0};  // as the motion model has it
  const Rigid3 truth{Eigen::Quaterniond::Identity(), {0.02, -0.01, 0.03}};
  const PosePrior prior = Within(expected, 0.05, 0.02);
  const PosePrior found = RegisterDepth(*SeePlanes({kBackWall}, truth), {}, *SeePlanes({kBackWall}, {}), {}, prior, {});
  EXPECT_NEAR(found.camera_from_world.translation.x(), 0.02, 1e-4);
  EXPECT_NEAR(found.camera_from_world.translation.y(), -0.01, 1e-4);
  EXPECT_NEAR(found.camera_from_world.translation.z(), 0.03, 1e-3);
  EXPECT_NEAR(found.information(0, 0) / prior.information(0, 0), 1, 1e-3);
  EXPECT_NEAR(found.information(1, 1) / prior.information(1, 1), 1, 1e-3);
}

// Planes through noise lean at random; if they leaned much, they would hold the camera where it was.
TEST(RegisterDepth, NoiseDoesNotHoldTheCameraBack) {
  Rigid3 truth;
  truth.translation = {0.02, 0, 0};
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const PosePrior found =
        RegisterDepth(*SeePlanes({kBackWall}, truth, 1, seed), {}, *SeePlanes({kBackWall}, {}, 1, seed + 100), {},
                      Within(truth, 0.005, 0.01), {});
    EXPECT_NEAR(found.camera_from_world.translation.x(), 0.02, 0.002) << seed;
    EXPECT_NEAR(found.camera_from_world.translation.z(), 0, 0.005) << seed;
  }
}

TEST(RegisterDepth, UsesOnlyWhatIsSaidToKeepStill) {
  const Board board{20, 60};
  const auto view = SeeBoard(board);
  const auto frame = SeeBoard(board, {}, kBoardDepth - 0.04F);  // the board has come nearer, not the camera
  std::vector<std::uint8_t> wall;
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 0; column < kBoardColumns; ++column) {
      wall.push_back(board.Covers(column, row) ? 0 : 1);
    }
  }
  const PosePrior prior = Within({}, 0.05, 0.05);
  EXPECT_GT(DistanceBetween(RegisterDepth(*frame, {}, *view, {}, prior, {}).camera_from_world, {}), 0.01);
  EXPECT_LT(DistanceBetween(RegisterDepth(*frame, wall, *view, {}, prior, {}).camera_from_world, {}), 0.001);
}

TEST(RegisterDepth, KeepsThePriorWhereTooLittleOverlaps) {
  const Rigid3 away{ExpSo3({0, 1.4, 0}), {0, 0, 0}};
  const PosePrior prior = Within(away, 0.05, 0.05);
  const auto view = SeePlanes(kCorner, {});
  const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(kBoardColumns * kBoardRows), 0);
  for (const PosePrior& found : {RegisterDepth(*SeePlanes(kCorner, away), {}, *view, {}, prior, {}),
                                 RegisterDepth(*SeePlanes(kCorner, {}), nothing, *view, {}, prior, {})}) {
    EXPECT_EQ(found.camera_from_world.translation, prior.camera_from_world.translation);
    EXPECT_EQ(found.information, prior.information);
  }
}

TEST(RegisterDepth, SurvivesFramesWithoutDepth) {
  const auto view = SeePlanes(kCorner, {});
  const auto without =
      std::make_shared<const FrameData>(TestCamera(), std::vector<Keypoint>{}, std::vector<Descriptor>{}, DepthGrid{});
  const PosePrior prior = Within({}, 0.05, 0.05);
  EXPECT_EQ(RegisterDepth(*without, {}, *view, {}, prior, {}).information, prior.information);
  EXPECT_EQ(RegisterDepth(*view, {}, *without, {}, prior, {}).information, prior.information);
}

}  // namespace
}  // namespace rds
