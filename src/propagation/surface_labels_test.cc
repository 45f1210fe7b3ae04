// SPDX-License-Identifier: Apache-2.0
#include "propagation/surface_labels.h"

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
  std::vector<float> samples = grid.depth_m();
  for (int row = 0; row < kRows; ++row) {
    samples[grid.Index(column, row)] = depth_m;
  }
  grid = DepthGrid(kColumns, kRows, std::move(samples));
}

SurfaceLabelOptions MaxDistance(int reach_px) {
  SurfaceLabelOptions options;
  options.max_dynamic_distance_px = reach_px;
  options.max_static_distance_px = reach_px;
  return options;
}

// Adds one label.
void Add(SurfaceLabels& labels, int column, int row, bool dynamic, int distance_px = 0, int columns = kColumns,
         int rows = kRows) {
  std::vector<SurfaceLabel> samples(static_cast<std::size_t>(columns * rows));
  samples[static_cast<std::size_t>(row * columns + column)] = {static_cast<std::uint16_t>(distance_px), dynamic};
  labels.Add(samples);
}

SurfaceLabel At(const SurfaceLabels& labels, int column, int row, int columns = kColumns) {
  return labels.Labels()[static_cast<std::size_t>(row * columns + column)];
}

bool IsKnown(const SurfaceLabels& labels, int column, int row) { return At(labels, column, row).IsKnown(); }

TEST(SurfaceLabelsTest, ALabelReachesItsSurfaceWithItsDistance) {
  SurfaceLabels labels(MaxDistance(200));
  labels.Start(Plane(2));
  Add(labels, 3, 5, true, 10);
  labels.Spread();
  EXPECT_TRUE(At(labels, 3, 5).dynamic);
  EXPECT_EQ(At(labels, 3, 5).distance_px, 10);
  EXPECT_EQ(At(labels, 8, 5).distance_px, 10 + 5 * 8);
  EXPECT_EQ(At(labels, 8, 7).distance_px, 10 + 3 * 8 + 2 * 11);
  EXPECT_EQ(labels.Labels().size(), std::size_t{kColumns} * kRows);
}

TEST(SurfaceLabelsTest, StopsAtItsReachAtAJumpInDepthAndWhereThereIsNoDepth) {
  DepthGrid grid = Plane(2);
  FillColumn(grid, 10, 0);
  SurfaceLabels labels(MaxDistance(41));
  labels.Start(grid);
  Add(labels, 2, 5, true);
  Add(labels, 9, 5, false);
  labels.Spread();
  EXPECT_TRUE(IsKnown(labels, 2, 0));    // 40 px
  EXPECT_FALSE(IsKnown(labels, 10, 5));  // no depth
  EXPECT_FALSE(IsKnown(labels, 11, 5));  // behind the gap
  EXPECT_FALSE(IsKnown(labels, 19, 9));  // too far away
  FillColumn(grid, 5, 2.2F);             // a jump of a tenth
  labels.Start(grid);
  Add(labels, 4, 5, true);
  labels.Spread();
  EXPECT_TRUE(IsKnown(labels, 3, 5));
  EXPECT_FALSE(IsKnown(labels, 6, 5));
}

TEST(SurfaceLabelsTest, ASlantedSurfaceIsOneSurface) {
  DepthGrid grid = Plane(2);
  for (int column = 0; column < kColumns; ++column) {
    FillColumn(grid, column, 2.0F + 0.04F * static_cast<float>(column));
  }
  SurfaceLabels labels(MaxDistance(200));
  labels.Start(grid);
  Add(labels, 0, 5, false);
  labels.Spread();
  EXPECT_TRUE(IsKnown(labels, 19, 5));
  EXPECT_FALSE(At(labels, 19, 5).dynamic);
}

TEST(SurfaceLabelsTest, TheNearestLabelWinsWhateverTheOrder) {
  for (const bool swapped : {false, true}) {
    SurfaceLabels labels(MaxDistance(200));
    labels.Start(Plane(1.5));
    Add(labels, swapped ? 12 : 2, 5, !swapped);
    Add(labels, swapped ? 2 : 12, 5, swapped);
    labels.Spread();
    EXPECT_TRUE(At(labels, 6, 5).dynamic);
    EXPECT_FALSE(At(labels, 8, 5).dynamic);
  }
}

TEST(SurfaceLabelsTest, OfLabelsOfOneSampleTheNearestCountsAndOfEqualOnesTheFirst) {
  SurfaceLabels labels(MaxDistance(200));
  labels.Start(Plane(1.5));
  Add(labels, 5, 5, true, 20);
  Add(labels, 5, 5, false, 20);
  Add(labels, 9, 5, true, 20);
  Add(labels, 9, 5, false, 19);
  EXPECT_TRUE(At(labels, 5, 5).dynamic);
  EXPECT_FALSE(At(labels, 9, 5).dynamic);
}

TEST(SurfaceLabelsTest, TakesLabelsOfAMaskAndAddsToTheirDistance) {
  SurfaceLabels labels(MaxDistance(12));
  labels.Start(Plane(1.5));
  std::vector<KeypointLabel> mask(std::size_t{kColumns} * kRows, KeypointLabel::kNone);
  mask[0] = KeypointLabel::kDynamic;
  mask[kColumns - 1] = KeypointLabel::kStatic;
  labels.Add(mask, 3);
  EXPECT_TRUE(At(labels, 0, 0).dynamic);
  EXPECT_EQ(At(labels, 0, 0).distance_px, 3);
  EXPECT_TRUE(IsKnown(labels, kColumns - 1, 0));
  EXPECT_FALSE(At(labels, kColumns - 1, 0).dynamic);
  EXPECT_FALSE(IsKnown(labels, 5, 5));
  labels.Start(Plane(1.5));
  labels.Add(mask, 12);  // beyond its reach
  EXPECT_FALSE(IsKnown(labels, 0, 0));
  labels.Add(std::vector<KeypointLabel>{});  // nothing known
  EXPECT_THROW(labels.Add(std::vector<KeypointLabel>(5)), InvariantError);
}

TEST(SurfaceLabelsTest, EachKindOfLabelHasItsOwnReach) {
  SurfaceLabelOptions options;
  options.max_dynamic_distance_px = 60;
  options.max_static_distance_px = 20;
  SurfaceLabels labels(options);
  labels.Start(Plane(1.5));
  Add(labels, 2, 2, true);
  Add(labels, 18, 8, false);
  labels.Spread();
  EXPECT_TRUE(IsKnown(labels, 9, 2));    // 56 px
  EXPECT_FALSE(IsKnown(labels, 10, 2));  // 64 px
  EXPECT_TRUE(IsKnown(labels, 16, 8));   // 16 px
  EXPECT_FALSE(IsKnown(labels, 15, 8));  // 24 px
}

TEST(SurfaceLabelsTest, TakesTheGridOfALargeImage) {
  SurfaceLabels labels(MaxDistance(50));
  labels.Start({480, 270, std::vector<float>(std::size_t{480} * 270, 2.0F)});  // 3840 x 2160
  Add(labels, 470, 260, true, 0, 480, 270);
  labels.Spread();
  EXPECT_TRUE(At(labels, 475, 260, 480).IsKnown());
  EXPECT_FALSE(At(labels, 5, 5, 480).IsKnown());
}

TEST(SurfaceLabelsTest, StartForgets) {
  SurfaceLabels labels({});
  labels.Start(Plane(2));
  Add(labels, 2, 5, true);
  labels.Spread();
  labels.Start(Plane(2));
  labels.Spread();
  EXPECT_FALSE(IsKnown(labels, 2, 5));
  labels.Start({});  // a frame without a grid
  labels.Spread();
  EXPECT_TRUE(labels.Labels().empty());
}

}  // namespace
}  // namespace rds
