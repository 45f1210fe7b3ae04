// SPDX-License-Identifier: Apache-2.0
#include "feature/depth_lookup.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace rds {
namespace {

TEST(DepthLookup, HolesOfADenseImageStayHoles) {
  Image16 depth(64, 48, 1, 5000);
  for (int y = 10; y < 30; ++y) {
    std::fill(depth.Row(y) + 20, depth.Row(y) + 50, std::uint16_t{0});
  }
  depth.At(5, 5) = 65535;
  const DepthLookup lookup(depth);
  EXPECT_EQ(lookup.reach_px(), 0);
  EXPECT_EQ(lookup.At(3, 3), 5000);
  EXPECT_EQ(lookup.At(20, 10), 0);
  EXPECT_EQ(lookup.At(5, 5), 0);
}

TEST(DepthLookup, AMostlyEmptyImageOfDenseRegionsIsDense) {
  Image16 depth(640, 480);
  for (int y = 200; y < 260; ++y) {
    std::fill(depth.Row(y) + 300, depth.Row(y) + 360, std::uint16_t{5000});
  }
  EXPECT_EQ(DepthLookup(depth).reach_px(), 0);
  EXPECT_EQ(DepthLookup(Image16(640, 480)).reach_px(), 0);
}

// A wall, slanted to the right, with a box before its right half; depth on every third or fourth pixel only.
TEST(DepthLookup, PixelsOfASparseImageTakeTheDepthOfTheirSurface) {
  const auto truth = [](int x) { return static_cast<double>(x < 320 ? 10000 + 2 * x : 5000); };
  Random random(1);
  for (const bool grid : {true, false}) {
    Image16 depth(640, 480);
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        if (grid ? x % 4 == 1 && y % 3 == 1 : random.Uniform(0, 1) < 0.07) {
          depth.At(x, y) = static_cast<std::uint16_t>(truth(x));
        }
      }
    }
    const DepthLookup lookup(depth);
    EXPECT_GE(lookup.reach_px(), 4);
    int with_depth = 0;
    for (int y = 20; y < 460; y += 3) {
      for (int x = 20; x < 620; x += 5) {
        const std::uint16_t raw = lookup.At(x, y);
        if (raw != 0) {
          EXPECT_NEAR(raw, truth(x), 20) << x << " " << y;
          ++with_depth;
        } else {
          EXPECT_TRUE(!grid || std::abs(x - 320) <= 8) << "no depth only where two surfaces meet: " << x;
        }
      }
    }
    EXPECT_GT(with_depth, 0.95 * 147 * 120);
  }
}

TEST(DepthLookup, LinesOfALaserAreSparse) {
  Image16 depth(640, 480);
  for (int y = 4; y < 480; y += 8) {
    std::fill(depth.Row(y), depth.Row(y) + 640, std::uint16_t{7000});
  }
  const DepthLookup lookup(depth);
  EXPECT_EQ(lookup.At(100, 104), 7000);
  EXPECT_EQ(lookup.At(100, 101), 7000);
}

}  // namespace
}  // namespace rds
