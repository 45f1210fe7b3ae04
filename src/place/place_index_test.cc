// SPDX-License-Identifier: Apache-2.0
#include "place/place_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/random.h"
#include "feature/orb.h"
#include "testing/small_world.h"

namespace rds {
namespace {

Descriptor Look(Random& random) { return {random.Bits(), random.Bits(), random.Bits(), random.Bits()}; }

std::vector<Descriptor> Looks(Random& random, int count) {
  std::vector<Descriptor> looks;
  for (int i = 0; i < count; ++i) {
    looks.push_back(Look(random));
  }
  return looks;
}

// As another view shows them.
std::vector<Descriptor> Blurred(std::vector<Descriptor> looks, Random& random, int flips = 20) {
  for (Descriptor& look : looks) {
    for (int i = 0; i < flips; ++i) {
      const std::uint32_t bit = random.Index(256);
      look[bit >> 6U] ^= std::uint64_t{1} << (bit & 63U);
    }
  }
  return looks;
}

KeyframeId Best(const std::vector<PlaceScore>& scores) {
  const auto best = std::ranges::max_element(scores, {}, &PlaceScore::score);
  return best != scores.end() ? best->keyframe : KeyframeId{};
}

struct Scene {
  Random random{3};
  std::vector<std::vector<Descriptor>> places;
  PlaceIndex index;

  explicit Scene(int count, int looks = 500) {
    for (int i = 0; i < count; ++i) {
      places.push_back(Looks(random, looks));
      index.Add(KeyframeId{static_cast<std::uint32_t>(i)}, places.back());
    }
  }
};

TEST(PlaceIndex, EachPlaceIsFoundByABlurredLook) {
  Scene scene(300);
  for (std::uint32_t i = 0; i < 300; i += 7) {
    EXPECT_EQ(Best(scene.index.Query(Blurred(scene.places[i], scene.random))), KeyframeId{i});
  }
}

TEST(PlaceIndex, AnswersAreAscendingAndTheSameEachTime) {
  Scene scene(100);
  const auto once = scene.index.Query(scene.places[5]);
  const auto again = scene.index.Query(scene.places[5]);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].keyframe, again[i].keyframe);
    EXPECT_EQ(once[i].score, again[i].score);
    EXPECT_TRUE(i == 0 || once[i - 1].keyframe < once[i].keyframe);
  }
}

TEST(PlaceIndex, AKeyframeThatIsAddedAgainIsFoundByItsNewLooksOnly) {
  Scene scene(60);
  const std::vector<Descriptor> fresh = Looks(scene.random, 500);
  scene.index.Add(KeyframeId{7}, fresh);
  EXPECT_EQ(scene.index.size(), 60U);
  EXPECT_EQ(Best(scene.index.Query(fresh)), KeyframeId{7});
  EXPECT_NE(Best(scene.index.Query(scene.places[7])), KeyframeId{7});
}

TEST(PlaceIndex, WhatIsRemovedIsGoneAndItsMemoryToo) {
  Scene scene(400);
  const std::size_t before = scene.index.Memory();
  for (std::uint32_t i = 0; i < 300; ++i) {
    scene.index.Remove(KeyframeId{i});
  }
  scene.index.Remove(KeyframeId{5000});  // was never there
  EXPECT_EQ(scene.index.size(), 100U);
  EXPECT_LT(scene.index.Memory(), before / 2);
  EXPECT_GE(Best(scene.index.Query(scene.places[5])), KeyframeId{300});
  for (std::uint32_t i = 300; i < 400; i += 9) {
    EXPECT_EQ(Best(scene.index.Query(Blurred(scene.places[i], scene.random))), KeyframeId{i});
  }
}

TEST(PlaceIndex, WhatAllKeyframesShowSaysNothing) {
  Random random(4);
  const std::vector<Descriptor> everywhere = Looks(random, 300);
  PlaceIndex index;
  std::vector<Descriptor> looks;
  for (std::uint32_t i = 0; i < 200; ++i) {
    looks = Looks(random, 50);
    std::vector<Descriptor> all = everywhere;
    all.insert(all.end(), looks.begin(), looks.end());
    index.Add(KeyframeId{i}, all);
  }
  for (const PlaceScore& score : index.Query(everywhere)) {
    EXPECT_LT(score.score, 10) << score.keyframe.value;  // by chance
  }
  EXPECT_EQ(Best(index.Query(looks)), KeyframeId{199});
}

TEST(PlaceIndex, NeedsLittleMemory) {
  const Scene scene(3000);
  EXPECT_LT(static_cast<double>(scene.index.Memory()) / 3000, 20'000);
}

TEST(PlaceIndex, AnEmptyOneKnowsNothing) {
  Random random(1);
  const PlaceIndex index;
  EXPECT_TRUE(index.Query(Looks(random, 100)).empty());
  EXPECT_FALSE(index.Has(KeyframeId{0}));
  EXPECT_TRUE(index.Keyframes().empty());
}

// The chosen bits are worth nearly as much as fair coins on pictures, too.
TEST(PlaceIndex, WordsOfARenderedRoomAreSpreadWide) {
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  OrbExtractor extractor{OrbOptions{}};
  std::vector<Descriptor> looks;
  for (const SyntheticFrame& frame : Frames(SyntheticScenario::kStatic)) {
    const FrameData data = extractor.Extract(camera, *frame.rgbd.image, *frame.rgbd.depth);
    looks.insert(looks.end(), data.descriptors().begin(), data.descriptors().end());
  }
  ASSERT_GT(looks.size(), 20'000U);
  const auto entropy_bits = [&](const auto& word_of) {
    std::map<std::uint16_t, int> counts;
    for (const Descriptor& look : looks) {
      ++counts[word_of(look)];
    }
    double entropy = 0;
    for (const auto& [word, count] : counts) {
      const double share = static_cast<double>(count) / static_cast<double>(looks.size());
      entropy -= share * std::log2(share);
    }
    return entropy;
  };
  const double consecutive = entropy_bits([](const Descriptor& look) { return static_cast<std::uint16_t>(look[0]); });
  for (int table = 0; table < PlaceIndex::kTables; ++table) {
    const double chosen = entropy_bits([&](const Descriptor& look) { return PlaceIndex::Word(table, look); });
    EXPECT_GT(chosen, 10) << table;
    EXPECT_GT(chosen, consecutive) << table;
  }
}

TEST(PlaceIndex, NoBitIsInTwoWords) {
  std::set<std::uint32_t> bits;
  for (std::uint32_t bit = 0; bit < 256; ++bit) {
    Descriptor look{};
    look[bit >> 6U] = std::uint64_t{1} << (bit & 63U);
    int words = 0;
    for (int table = 0; table < PlaceIndex::kTables; ++table) {
      words += PlaceIndex::Word(table, look) != 0 ? 1 : 0;
    }
    EXPECT_LE(words, 1) << bit;
    if (words == 1) {
      bits.insert(bit);
    }
  }
  EXPECT_EQ(bits.size(), static_cast<std::size_t>(PlaceIndex::kTables * PlaceIndex::kBits));
}

}  // namespace
}  // namespace rds
