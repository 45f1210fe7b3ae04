// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "propagation/motion_comparison.h"
#include "segmentation/mask.h"
#include "testing/board.h"
#include "testing/view.h"

namespace rds {
namespace {

// A wall of few corners behind a thing with many: points in the world, each with a look of its own.
class Room {
 public:
  Room(std::uint32_t corners_of_room, std::uint32_t corners_of_thing) : thing_(corners_of_room) {
    Random random(3);
    for (std::uint32_t i = 0; i < corners_of_room; ++i) {
      Add(random, {random.Uniform(-1.7, 1.7), random.Uniform(-1.25, 1.25), kWall_m});
    }
    for (std::uint32_t i = 0; i < corners_of_thing; ++i) {
      Add(random, {random.Uniform(-kHalf_m, kHalf_m), random.Uniform(-kHalf_m, kHalf_m), kThing_m});
    }
  }

  [[nodiscard]] bool IsThing(std::size_t point) const { return point >= thing_; }
  void MoveThing(const Eigen::Vector3d& by) {
    moved_ += by;
    for (std::size_t i = thing_; i < points_.size(); ++i) {
      points_[i] += by;
    }
  }
  // With the noise of a camera: keypoint i shows point i. All lie in the picture.
  [[nodiscard]] std::shared_ptr<const FrameData> See(const Rigid3& camera_from_world, std::uint64_t seed) const {
    Random random(seed);
    std::vector<Keypoint> keypoints;
    for (const Eigen::Vector3d& point : points_) {
      Keypoint keypoint = rds::See(camera_from_world, point);
      keypoint.x = keypoint.raw_x += static_cast<float>(random.Gaussian(0, 0.5));
      keypoint.y = keypoint.raw_y += static_cast<float>(random.Gaussian(0, 0.5));
      keypoint.depth_m += static_cast<float>(random.Gaussian(0, static_cast<double>(keypoint.depth_sigma_m)));
      keypoints.push_back(keypoint);
    }
    std::erase_if(keypoints, [](const Keypoint& keypoint) {
      return keypoint.depth_m <= 0 || keypoint.x < 0 || keypoint.y < 0 || keypoint.x >= 640 || keypoint.y >= 480;
    });
    Check(keypoints.size() == points_.size(), "all points lie in the picture");
    return std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), looks_, Depth(camera_from_world));
  }

 private:
  static constexpr double kWall_m = 3;
  static constexpr double kThing_m = 1.25;
  static constexpr double kHalf_m = 0.25;

  void Add(Random& random, const Eigen::Vector3d& point) {
    points_.push_back(point);
    looks_.push_back({random.Bits(), random.Bits(), random.Bits(), random.Bits()});
  }
  [[nodiscard]] DepthGrid Depth(const Rigid3& camera_from_world) const {
    const Rigid3 world_from_camera = camera_from_world.Inverse();
    std::vector<float> depth_m;
    for (int row = 0; row < kBoardRows; ++row) {
      for (int column = 0; column < kBoardColumns; ++column) {
        const Eigen::Vector3d ray =
            world_from_camera.rotation *
            TestCamera().Unproject({DepthGrid::MiddlePixel(column), DepthGrid::MiddlePixel(row)}, 1);
        const auto depth_of = [&](double z) { return (z - world_from_camera.translation.z()) / ray.z(); };
        const double near_m = depth_of(kThing_m + moved_.z());
        const Eigen::Vector3d hit = world_from_camera.translation + near_m * ray - moved_;
        const bool on_thing = std::max(std::abs(hit.x()), std::abs(hit.y())) < kHalf_m && thing_ < points_.size();
        depth_m.push_back(static_cast<float>(on_thing ? near_m : depth_of(kWall_m)));
      }
    }
    return {kBoardColumns, kBoardRows, std::move(depth_m)};
  }

  std::size_t thing_;
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> looks_;
};

const Rigid3 kStep{ExpSo3({0.01, 0.03, 0}), {0.08, 0.02, 0.03}};  // of the camera

struct Shares {
  double thing_dynamic = 0;
  double room_dynamic = 0;
  double room_static = 0;
};

Shares Count(const Room& room, const std::vector<KeypointLabel>& labels) {
  Shares shares;
  double things = 0;
  double rooms = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double dynamic = labels[i] == KeypointLabel::kDynamic ? 1 : 0;
    (room.IsThing(i) ? things : rooms) += 1;
    (room.IsThing(i) ? shares.thing_dynamic : shares.room_dynamic) += dynamic;
    shares.room_static += !room.IsThing(i) && labels[i] == KeypointLabel::kStatic ? 1 : 0;
  }
  return {shares.thing_dynamic / things, shares.room_dynamic / rooms, shares.room_static / rooms};
}

TEST(SegmentByMotion, AThingWithMostOfTheCornersIsOutvotedByTheAreaOfTheRoom) {
  Room room(150, 300);
  const auto witness = room.See({}, 1);
  room.MoveThing({0.25, 0, 0.05});
  const auto frame = room.See(kStep, 2);
  const auto segmented = SegmentByMotion(*frame, {}, *witness, std::nullopt, ScalePyramid());
  ASSERT_TRUE(segmented);
  const Shares shares = Count(room, segmented->labels);
  EXPECT_GT(shares.thing_dynamic, 0.95);
  EXPECT_EQ(shares.room_dynamic, 0);
  EXPECT_GT(shares.room_static, 0.9);
  EXPECT_FALSE(segmented->contradicts);  // nothing was expected
}

TEST(SegmentByMotion, WhereNothingMovesNothingIsDynamic) {
  const Room room(150, 300);
  const auto witness = room.See({}, 1);
  const auto segmented = SegmentByMotion(*room.See(kStep, 2), {}, *witness, kStep.Inverse(), ScalePyramid());
  ASSERT_TRUE(segmented);
  EXPECT_EQ(std::ranges::count(segmented->labels, KeypointLabel::kDynamic), 0);
  EXPECT_FALSE(segmented->contradicts);
}

TEST(SegmentByMotion, APoseThatFollowsTheThingIsContradicted) {
  Room room(150, 300);
  const auto witness = room.See({}, 1);
  const Eigen::Vector3d moved(0.25, 0, 0.05);
  room.MoveThing(moved);
  const auto frame = room.See(kStep, 2);
  const Rigid3 right = kStep.Inverse();
  // As if the thing had kept still: it is where it was in the witness's view.
  const Rigid3 with_the_thing = Rigid3{Eigen::Quaterniond::Identity(), -moved} * right;
  const auto judge = [&](const Rigid3& expected) {
    return SegmentByMotion(*frame, {}, *witness, expected, ScalePyramid());
  };
  EXPECT_FALSE(judge(right)->contradicts);
  EXPECT_TRUE(judge(with_the_thing)->contradicts);
  EXPECT_GT(Count(room, judge(with_the_thing)->labels).thing_dynamic, 0.95);
}

TEST(SegmentByMotion, AFewStrayMatchesAreNotAThing) {
  Room room(150, 4);  // of which three each have but three neighbors
  const auto witness = room.See({}, 1);
  room.MoveThing({0.25, 0, 0.05});
  const auto segmented = SegmentByMotion(*room.See(kStep, 2), {}, *witness, std::nullopt, ScalePyramid());
  ASSERT_TRUE(segmented);
  EXPECT_EQ(std::ranges::count(segmented->labels, KeypointLabel::kDynamic), 0);
}

TEST(SegmentByMotion, WhatIsKnownToBeDynamicHasNoSay) {
  Room room(100, 300);
  const auto witness = room.See({}, 1);
  room.MoveThing({0.25, 0, 0.05});
  const auto frame = room.See(kStep, 2);
  std::vector<KeypointLabel> known(frame->size(), KeypointLabel::kNone);
  for (std::size_t i = 0; i < known.size(); ++i) {
    known[i] = room.IsThing(i) ? KeypointLabel::kNone : KeypointLabel::kDynamic;
  }
  const auto segmented = SegmentByMotion(*frame, known, *witness, std::nullopt, ScalePyramid());
  ASSERT_TRUE(segmented);  // the thing is all that is left
  EXPECT_EQ(std::ranges::count(segmented->labels, KeypointLabel::kDynamic), 0);
}

TEST(SegmentByMotion, ViewsWithLittleInCommonSayNothing) {
  const Room room(40, 10);
  EXPECT_FALSE(SegmentByMotion(*room.See(kStep, 2), {}, *room.See({}, 1), std::nullopt, ScalePyramid()));
  const Room large(200, 10);
  const Room other(200, 200);  // other looks
  EXPECT_FALSE(SegmentByMotion(*large.See(kStep, 2), {}, *FrameOf({}), std::nullopt, ScalePyramid()));
  EXPECT_FALSE(SegmentByMotion(*FrameOf({}), {}, *other.See({}, 1), std::nullopt, ScalePyramid()));
}

TEST(CompareMotions, SurfacesCountNotCorners) {
  Room room(40, 400);
  const auto witness = room.See({}, 1);
  const Eigen::Vector3d moved(0.25, 0, 0.05);
  room.MoveThing(moved);
  const auto frame = room.See(kStep, 2);
  const Rigid3 of_room = kStep.Inverse();
  const Rigid3 of_thing = Rigid3{Eigen::Quaterniond::Identity(), -moved} * of_room;
  const MotionShares shares = CompareMotions(*frame, {}, *witness, of_room, of_thing, ScalePyramid());
  EXPECT_NEAR(shares.other, 0.13, 0.03);  // of the picture, as large as the thing is
  EXPECT_GT(shares.one, 0.5);
  const MotionShares none = CompareMotions(*frame, {}, *witness, of_room, of_room, ScalePyramid());
  EXPECT_EQ(none.one, 0);
  EXPECT_EQ(none.other, 0);
}

// A keypoint at a sample of a view of the board.
Keypoint AtSample(const Board& board, int column, int row) {
  Keypoint keypoint;
  keypoint.x = keypoint.raw_x = static_cast<float>(DepthGrid::MiddlePixel(column));
  keypoint.y = keypoint.raw_y = static_cast<float>(DepthGrid::MiddlePixel(row));
  keypoint.depth_m = board.Covers(column, row) ? kBoardDepth : kWallDepth;
  return keypoint;
}

TEST(DrawSurfaces, LabelsReachTheEndOfTheirSurface) {
  const Board board{30, 50};
  const auto data = SeeBoard(board, {AtSample(board, 40, 30), AtSample(board, 25, 30)});
  const std::vector<KeypointLabel> labels = {KeypointLabel::kDynamic, KeypointLabel::kStatic};
  Image8 mask(data->camera().width, data->camera().height, 1, kUnsurePixel);
  const auto at = [&](int column, int row) -> std::uint8_t& {
    return mask.At(DepthGrid::MiddlePixel(column), DepthGrid::MiddlePixel(row));
  };
  DrawSurfaces(*data, labels, mask);
  EXPECT_EQ(at(32, 30), kDynamicPixel);
  EXPECT_EQ(at(27, 30), kStaticPixel);  // the wall beside it
  EXPECT_EQ(at(70, 30), kUnsurePixel);  // too far away
  mask = Image8(data->camera().width, data->camera().height, 1, kStaticPixel);
  at(20, 30) = kDynamicPixel;  // a network's
  DrawSurfaces(*data, labels, mask);
  EXPECT_EQ(at(20, 30), kDynamicPixel);
  EXPECT_EQ(at(32, 30), kDynamicPixel);
}

}  // namespace
}  // namespace rds
