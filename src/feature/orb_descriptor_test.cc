// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_descriptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

#include "base/random.h"
#include "feature/orb_pattern.h"

namespace rds {
namespace {

constexpr int kSize = 48;

std::vector<std::uint8_t> RandomPatch(std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint8_t> patch(static_cast<std::size_t>(kSize * kSize));
  for (std::uint8_t& value : patch) {
    value = static_cast<std::uint8_t>(random.Index(256));
  }
  return patch;
}

std::uint8_t* CenterOf(std::vector<std::uint8_t>& patch) { return &patch[kSize * 24 + 24]; }

TEST(OrbPattern, HasDistinctPairsWithinTheRadius) {
  std::set<std::tuple<int, int, int, int>> seen;
  for (const PixelPair& pair : OrbPattern()) {
    EXPECT_LE(pair.ax * pair.ax + pair.ay * pair.ay, kPatchRadius * kPatchRadius);
    EXPECT_LE(pair.bx * pair.bx + pair.by * pair.by, kPatchRadius * kPatchRadius);
    EXPECT_GE(std::hypot(pair.ax - pair.bx, pair.ay - pair.by), 4);
    EXPECT_TRUE(seen.emplace(pair.ax, pair.ay, pair.bx, pair.by).second);
    EXPECT_FALSE(seen.contains({pair.bx, pair.by, pair.ax, pair.ay}));
  }
}

TEST(OrientationAt, PointsToTheBrightSide) {
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const double angle = degrees * 3.14159265358979 / 180;
    std::vector<std::uint8_t> patch(static_cast<std::size_t>(kSize * kSize));
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double along = (x - 24) * std::cos(angle) + (y - 24) * std::sin(angle);
        patch[static_cast<std::size_t>(y * kSize + x)] = static_cast<std::uint8_t>(128 + 3 * along);
      }
    }
    const float found = OrientationAt(CenterOf(patch), kSize).AngleDeg();
    EXPECT_GE(found, 0);
    EXPECT_LT(found, 360);
    EXPECT_NEAR(std::remainder(static_cast<double>(found) - degrees, 360.0), 0, 1.5) << degrees;
  }
  std::vector<std::uint8_t> flat(static_cast<std::size_t>(kSize * kSize), 77);
  EXPECT_EQ(OrientationAt(CenterOf(flat), kSize).AngleDeg(), 0);
}

TEST(OrientationAt, UsesARoundPatch) {
  std::vector<std::uint8_t> patch(static_cast<std::size_t>(kSize * kSize));
  std::uint8_t* const center = CenterOf(patch);
  center[std::ptrdiff_t{5} * kSize] = 100;
  EXPECT_FLOAT_EQ(OrientationAt(center, kSize).AngleDeg(), 90);
  center[-16] = 255;  // outside the patch: no effect
  center[std::ptrdiff_t{-12} * kSize - 12] = 255;
  EXPECT_FLOAT_EQ(OrientationAt(center, kSize).AngleDeg(), 90);
}

TEST(PatchDescriber, ComparesThePairsOfThePattern) {
  const PatchDescriber describer;
  std::vector<std::uint8_t> patch = RandomPatch(1);
  const std::uint8_t* const center = CenterOf(patch);
  struct Turn {
    int cosine;
    int sine;
  };
  for (const Turn turn : {Turn{1, 0}, Turn{0, 1}, Turn{-1, 0}, Turn{0, -1}}) {
    const Descriptor descriptor =
        describer.Describe(center, kSize, {static_cast<float>(turn.cosine), static_cast<float>(turn.sine)});
    for (std::size_t i = 0; i < 256; ++i) {
      const auto pixel = [&](int x, int y) {
        return center[(x * turn.sine + y * turn.cosine) * kSize + x * turn.cosine - y * turn.sine];
      };
      const PixelPair pair = OrbPattern()[i];
      const bool expected = pixel(pair.ax, pair.ay) < pixel(pair.bx, pair.by);
      EXPECT_EQ((descriptor[i / 64] >> (i % 64)) & 1U, expected ? 1U : 0U) << i;
    }
  }
}

TEST(PatchDescriber, DescribesDifferentPatchesDifferently) {
  const PatchDescriber describer;
  std::vector<std::uint8_t> a = RandomPatch(2);
  std::vector<std::uint8_t> b = RandomPatch(3);
  const int distance =
      HammingDistance(describer.Describe(CenterOf(a), kSize, {}), describer.Describe(CenterOf(b), kSize, {}));
  EXPECT_GT(distance, 90);
  EXPECT_LT(distance, 166);
}

}  // namespace
}  // namespace rds
