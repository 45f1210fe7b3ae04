// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_fast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "feature/orb_select.h"

namespace rds {
namespace {

// The definition: the largest difference that all of some nine neighboring pixels of the circle keep from the center.
int NaiveScore(const GrayPlane& image, int x, int y) {
  constexpr std::array<std::array<int, 2>, 16> kCircle = {{{0, -3},
                                                           {1, -3},
                                                           {2, -2},
                                                           {3, -1},
                                                           {3, 0},
                                                           {3, 1},
                                                           {2, 2},
                                                           {1, 3},
                                                           {0, 3},
                                                           {-1, 3},
                                                           {-2, 2},
                                                           {-3, 1},
                                                           {-3, 0},
                                                           {-3, -1},
                                                           {-2, -2},
                                                           {-1, -3}}};
  int score = 0;
  for (std::size_t start = 0; start < 16; ++start) {
    int brighter = 255;
    int darker = 255;
    for (std::size_t i = start; i < start + 9; ++i) {
      const int difference = image.Row(y + kCircle[i % 16][1])[x + kCircle[i % 16][0]] - image.Row(y)[x];
      brighter = std::min(brighter, difference);
      darker = std::min(darker, -difference);
    }
    score = std::max({score, brighter, darker});
  }
  return score;
}

GrayPlane RandomPlane(int width, int height, std::uint64_t seed) {
  Random random(seed);
  GrayPlane plane;
  plane.Resize(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // Blobs with some noise, so that there are corners of all scores and also runs of equal ones.
      const bool bright = ((x / 5) * 7 + (y / 6) * 3) % 4 == 0;
      plane.Row(y)[x] = static_cast<std::uint8_t>((bright ? 180 : 60) + (y > height / 2 ? random.Index(40) : 0));
    }
  }
  return plane;
}

TEST(FastDetector, EqualsItsDefinition) {
  constexpr int kBorder = 4;
  constexpr int kThreshold = 12;
  FastDetector detector;
  for (const auto& [width, height] : {std::pair{150, 61}, {63, 64}, {9, 9}, {10, 30}, {8, 30}}) {
    const GrayPlane image = RandomPlane(width, height, 1);
    std::vector<Corner> corners;
    detector.Detect(image, kThreshold, kBorder, corners);
    std::vector<Corner> expected;
    for (int y = kBorder; y < height - kBorder; ++y) {
      for (int x = kBorder; x < width - kBorder; ++x) {
        const int score = NaiveScore(image, x, y);
        bool is_maximum = score > kThreshold;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            const int other = NaiveScore(image, x + dx, y + dy);
            const bool later = dy > 0 || (dy == 0 && dx > 0);
            is_maximum = is_maximum && ((dx == 0 && dy == 0) || (later ? score >= other : score > other));
          }
        }
        if (is_maximum) {
          expected.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                              static_cast<std::uint8_t>(score), 0, 0, 0, 0});
        }
      }
    }
    ASSERT_EQ(corners.size(), expected.size()) << width;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_EQ(corners[i].x, expected[i].x);
      EXPECT_EQ(corners[i].y, expected[i].y);
      EXPECT_EQ(corners[i].score, expected[i].score);
    }
    if (width == 150) {
      EXPECT_GT(corners.size(), 50U);
    }
  }
}

TEST(Corner, IsRefinedTowardTheLargerNeighbor) {
  const Corner corner{10, 20, 40, 20, 30, 40, 10};
  EXPECT_FLOAT_EQ(corner.FineX(), 10 + 10.0F / 60);
  EXPECT_FLOAT_EQ(corner.FineY(), 20 - 0.5F);
  const Corner flat{10, 20, 40, 40, 40, 40, 40};
  EXPECT_FLOAT_EQ(flat.FineX(), 10);
  EXPECT_FLOAT_EQ(flat.FineY(), 20);
}

TEST(CornerSelector, DropsWeakCornersBesideStrongOnes) {
  // Cells of 35 pixels.
  std::vector<Corner> corners = {{5, 5, 9}, {10, 8, 30}, {50, 10, 9}, {60, 20, 20}};
  CornerSelector().DropWeak(70, 35, 20, corners);
  ASSERT_EQ(corners.size(), 3U);
  EXPECT_EQ(corners[0].x, 10);
  EXPECT_EQ(corners[1].x, 50);
  EXPECT_EQ(corners[2].x, 60);
}

TEST(CornerSelector, PrefersTheBestOfEachCell) {
  // A cluster of strong corners and single weaker ones elsewhere.
  std::vector<Corner> corners;
  for (std::int16_t i = 0; i < 100; ++i) {
    corners.push_back({static_cast<std::int16_t>(i % 10), static_cast<std::int16_t>(i / 10), 100});
  }
  for (std::int16_t i = 1; i < 20; ++i) {
    corners.push_back({static_cast<std::int16_t>(50 * i), 50, 20});
  }
  CornerSelector().Spread(1000, 100, 24, corners);
  ASSERT_EQ(corners.size(), 24U);
  // By score alone there would be none.
  EXPECT_GE(std::count_if(corners.begin(), corners.end(), [](const Corner& c) { return c.score == 20; }), 10);

  std::vector<Corner> few = {{1, 1, 5}, {2, 2, 5}};
  CornerSelector().Spread(1000, 100, 2, few);
  EXPECT_EQ(few.size(), 2U);
  CornerSelector().Spread(1000, 100, 0, few);
  EXPECT_TRUE(few.empty());
}

}  // namespace
}  // namespace rds
