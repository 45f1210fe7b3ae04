#include "tracking/surface_labels.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace rds {
namespace {

constexpr int kColumns = 20;
constexpr int kRows = 10;

DepthGrid Plane(float depth_m) {
  return {kColumns, kRows, std::vector<float>(static_cast<std::size_t>(kColumns * kRows), depth_m)};
}

void FillColumn(DepthGrid& grid, int column, float depth_m) {
  for (int row = 0; row < kRows; ++row) {
    grid.depth_m[static_cast<std::size_t>(row * kColumns + column)] = depth_m;
  }
}

SurfaceLabelOptions Reach(int reach_px) {
  SurfaceLabelOptions options;
  options.dynamic_reach_px = reach_px;
  options.static_reach_px = reach_px;
  return options;
}

// The keypoint in the middle of a block of the grid.
Keypoint At(int column, int row, float depth_m) {
  Keypoint keypoint;
  keypoint.raw_x = static_cast<float>(column * kDepthGridStep + kDepthGridStep / 2);
  keypoint.raw_y = static_cast<float>(row * kDepthGridStep + kDepthGridStep / 2);
  keypoint.depth_m = depth_m;
  return keypoint;
}

TEST(SurfaceLabelsTest, ALabelReachesItsSurfaceWithItsDistance) {
  SurfaceLabels labels(Reach(200));
  labels.Start(Plane(2));
  labels.Add(At(3, 5, 2), {true, 10});
  labels.Spread();
  const auto here = labels.At(At(3, 5, 2));
  ASSERT_TRUE(here);
  EXPECT_TRUE(here->dynamic);
  EXPECT_EQ(here->distance_px, 10);
  const auto there = labels.At(At(8, 5, 2));
  ASSERT_TRUE(there);
  EXPECT_EQ(there->distance_px, 10 + 5 * 8);
  EXPECT_EQ(labels.At(At(8, 7, 2))->distance_px, 10 + 3 * 8 + 2 * 11);
}

TEST(SurfaceLabelsTest, StopsAtItsReachAtAJumpInDepthAndWhereThereIsNoDepth) {
  DepthGrid grid = Plane(2);
  FillColumn(grid, 10, 0);
  SurfaceLabels labels(Reach(41));
  labels.Start(grid);
  labels.Add(At(2, 5, 2), {true, 0});
  labels.Add(At(9, 5, 2), {false, 0});
  labels.Spread();
  EXPECT_TRUE(labels.At(At(2, 0, 2)));     // 40 px
  EXPECT_FALSE(labels.At(At(11, 5, 2)));   // behind the gap
  EXPECT_FALSE(labels.At(At(2, 5, 3)));    // another surface at the same place
  EXPECT_FALSE(labels.At(At(4, 5, 0)));    // no depth
  EXPECT_FALSE(labels.At(At(19, 9, 2)));   // too far away
  EXPECT_FALSE(labels.At(At(25, 15, 2)));  // outside the grid
  FillColumn(grid, 5, 2.2F);               // a jump of a tenth
  labels.Start(grid);
  labels.Add(At(4, 5, 2), {true, 0});
  labels.Spread();
  EXPECT_TRUE(labels.At(At(3, 5, 2)));
  EXPECT_FALSE(labels.At(At(6, 5, 2)));
}

TEST(SurfaceLabelsTest, ASlantedSurfaceIsOneSurface) {
  DepthGrid grid = Plane(2);
  for (int column = 0; column < kColumns; ++column) {
    FillColumn(grid, column, 2.0F + 0.04F * static_cast<float>(column));
  }
  SurfaceLabels labels(Reach(200));
  labels.Start(grid);
  labels.Add(At(0, 5, 2), {false, 0});
  labels.Spread();
  const auto far = labels.At(At(19, 5, 2.76F));
  ASSERT_TRUE(far);
  EXPECT_FALSE(far->dynamic);
}

TEST(SurfaceLabelsTest, TheNearestLabelWinsWhateverTheOrder) {
  for (const bool swapped : {false, true}) {
    SurfaceLabels labels(Reach(200));
    labels.Start(Plane(1.5));
    const Keypoint person = At(2, 5, 1.5);
    const Keypoint chair = At(12, 5, 1.5);
    labels.Add(swapped ? chair : person, {!swapped, 0});
    labels.Add(swapped ? person : chair, {swapped, 0});
    labels.Spread();
    EXPECT_TRUE(labels.At(At(6, 5, 1.5))->dynamic);
    EXPECT_FALSE(labels.At(At(8, 5, 1.5))->dynamic);
  }
}

TEST(SurfaceLabelsTest, EachKindOfLabelHasItsOwnReach) {
  SurfaceLabelOptions options;
  options.dynamic_reach_px = 60;
  options.static_reach_px = 20;
  SurfaceLabels labels(options);
  labels.Start(Plane(1.5));
  labels.Add(At(2, 2, 1.5), {true, 0});
  labels.Add(At(18, 8, 1.5), {false, 0});
  labels.Spread();
  EXPECT_TRUE(labels.At(At(9, 2, 1.5)));    // 56 px
  EXPECT_FALSE(labels.At(At(10, 2, 1.5)));  // 64 px
  EXPECT_TRUE(labels.At(At(16, 8, 1.5)));   // 16 px
  EXPECT_FALSE(labels.At(At(15, 8, 1.5)));  // 24 px
}

TEST(SurfaceLabelsTest, TellsWhereSomethingMoves) {
  SurfaceLabels labels(Reach(12));
  labels.Start(Plane(1.5));
  labels.Add(At(15, 5, 1.5), {false, 0});
  labels.Spread();
  EXPECT_TRUE(labels.Moving().empty());
  labels.Add(At(0, 0, 1.5), {true, 0});
  labels.Spread();
  const std::vector<std::uint8_t> moving = labels.Moving();
  ASSERT_EQ(std::ssize(moving), kColumns * kRows);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      // The label reaches 8 or 11 px, and its neighbours are marked as well.
      EXPECT_EQ(moving[static_cast<std::size_t>(row * kColumns + column)], row <= 2 && column <= 2 ? 1 : 0)
          << row << ", " << column;
    }
  }
}

TEST(SurfaceLabelsTest, TakesTheGridOfALargeImage) {
  SurfaceLabels labels(Reach(50));
  labels.Start({480, 270, std::vector<float>(std::size_t{480} * 270, 2.0F)});  // 3840 x 2160
  labels.Add(At(470, 260, 2), {true, 0});
  labels.Spread();
  EXPECT_TRUE(labels.At(At(475, 260, 2)));
  EXPECT_FALSE(labels.At(At(5, 5, 2)));
}

TEST(SurfaceLabelsTest, StartForgets) {
  SurfaceLabels labels({});
  labels.Start(Plane(2));
  labels.Add(At(2, 5, 2), {true, 0});
  labels.Spread();
  labels.Start(Plane(2));
  labels.Spread();
  EXPECT_FALSE(labels.At(At(2, 5, 2)));
  labels.Start({});  // a frame without a grid
  labels.Add(At(2, 5, 2), {true, 0});
  labels.Spread();
  EXPECT_FALSE(labels.At(At(2, 5, 2)));
}

}  // namespace
}  // namespace rds
