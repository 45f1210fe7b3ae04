// SPDX-License-Identifier: Apache-2.0
#include "propagation/mask_completion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "segmentation/mask.h"

namespace rds {
namespace {

constexpr int kColumns = 10;
constexpr int kRows = 4;
constexpr int kWidth = kColumns * kDepthGridStep;
constexpr int kHeight = kRows * kDepthGridStep;

// A person 1.5 m away in the columns up to 5, a wall 3 m away behind.
DepthGrid PersonBeforeAWall() {
  std::vector<float> depth_m;
  for (int i = 0; i < kColumns * kRows; ++i) {
    depth_m.push_back(i % kColumns <= 5 ? 1.5F : 3.0F);
  }
  return {kColumns, kRows, std::move(depth_m)};
}

Image8 Mask(std::uint8_t value) { return Image8(kWidth, kHeight, 1, value); }

void Fill(Image8& mask, int first_column, int last_column, std::uint8_t value) {
  for (int y = 0; y < kHeight; ++y) {
    std::fill(mask.Row(y) + first_column * kDepthGridStep, mask.Row(y) + (last_column + 1) * kDepthGridStep, value);
  }
}

TEST(CompleteMask, UnsurePixelsOnTheSurfaceOfDynamicOnesJoinThem) {
  Image8 mask = Mask(kUnsurePixel);
  Fill(mask, 1, 1, kDynamicPixel);
  CompleteMask(PersonBeforeAWall(), 0.04, mask);
  Image8 expected = Mask(kUnsurePixel);
  Fill(expected, 0, 5, kDynamicPixel);
  EXPECT_EQ(mask.data, expected.data);
}

TEST(CompleteMask, WhatIsStaticStaysSoAndStopsIt) {
  Image8 mask = Mask(kUnsurePixel);
  Fill(mask, 0, 0, kDynamicPixel);
  Fill(mask, 2, 2, kStaticPixel);
  CompleteMask(PersonBeforeAWall(), 0.04, mask);
  EXPECT_EQ(mask.At(1 * kDepthGridStep, 0), kDynamicPixel);
  EXPECT_EQ(mask.At(2 * kDepthGridStep, 0), kStaticPixel);
  EXPECT_EQ(mask.At(3 * kDepthGridStep, 0), kUnsurePixel);
}

TEST(CompleteMask, StopsWhereThereIsNoDepthAndLeavesMasksWithoutDoubtAlone) {
  std::vector<float> depth_m = PersonBeforeAWall().depth_m();
  for (int row = 0; row < kRows; ++row) {
    depth_m[static_cast<std::size_t>(row * kColumns + 3)] = 0;
  }
  const DepthGrid grid(kColumns, kRows, std::move(depth_m));
  Image8 mask = Mask(kUnsurePixel);
  Fill(mask, 0, 0, kDynamicPixel);
  CompleteMask(grid, 0.04, mask);
  EXPECT_EQ(mask.At(2 * kDepthGridStep, 0), kDynamicPixel);
  EXPECT_EQ(mask.At(3 * kDepthGridStep, 0), kUnsurePixel);
  EXPECT_EQ(mask.At(4 * kDepthGridStep, 0), kUnsurePixel);
  Image8 sure = Mask(kStaticPixel);
  Fill(sure, 0, 3, kDynamicPixel);
  const Image8 before = sure;
  CompleteMask(grid, 0.04, sure);
  EXPECT_EQ(sure.data, before.data);
  CompleteMask({}, 0.04, sure);  // a frame without a grid
  EXPECT_EQ(sure.data, before.data);
}

TEST(CompleteMask, RefusesAGridLargerThanTheMask) {
  Image8 mask(kWidth - 1, kHeight);
  EXPECT_THROW(CompleteMask(PersonBeforeAWall(), 0.04, mask), InvariantError);
}

}  // namespace
}  // namespace rds
