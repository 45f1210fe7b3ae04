// SPDX-License-Identifier: Apache-2.0
#include "base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rds {
namespace {

TEST(Random, IsTheSameOnEveryPlatform) {
  Random random(1234567);  // published test vector of SplitMix64
  EXPECT_EQ(random.Bits(), 6457827717110365317ULL);
  EXPECT_EQ(random.Bits(), 3203168211198807973ULL);
  EXPECT_EQ(random.Bits(), 9817491932198370423ULL);
}

TEST(Random, SeedDecides) {
  Random a(7);
  Random b(7);
  Random c(8);
  EXPECT_EQ(a.Gaussian(0, 1), b.Gaussian(0, 1));
  EXPECT_NE(a.Bits(), c.Bits());
}

TEST(Random, UniformFillsItsRange) {
  Random random(1);
  double low = 10;
  double high = -10;
  double sum = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.Uniform(-2, 3);
    low = std::min(low, value);
    high = std::max(high, value);
    sum += value;
  }
  EXPECT_GE(low, -2);
  EXPECT_LT(high, 3);
  EXPECT_LT(low, -1.99);
  EXPECT_GT(high, 2.99);
  EXPECT_NEAR(sum / kCount, 0.5, 0.02);
}

TEST(Random, IndexHitsEveryValueEvenly) {
  Random random(2);
  std::array<int, 7> hits{};
  for (int i = 0; i < 70000; ++i) {
    const std::uint32_t index = random.Index(7);
    ASSERT_LT(index, 7U);
    ++hits.at(index);
  }
  for (const int count : hits) {
    EXPECT_NEAR(count, 10000, 400);
  }
  EXPECT_EQ(random.Index(1), 0U);
}

TEST(Random, GaussianHasItsMoments) {
  Random random(3);
  constexpr int kCount = 200000;
  double sum = 0;
  double squares = 0;
  int within_sigma = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.Gaussian(1, 2);
    ASSERT_TRUE(std::isfinite(value));
    sum += value - 1;
    squares += (value - 1) * (value - 1);
    within_sigma += std::abs(value - 1) < 2 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.02);
  EXPECT_NEAR(squares / kCount, 4, 0.06);
  EXPECT_NEAR(static_cast<double>(within_sigma) / kCount, 0.6827, 0.005);
}

}  // namespace
}  // namespace rds
