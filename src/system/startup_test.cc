// SPDX-License-Identifier: Apache-2.0
#include "system/startup.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "testing/small_world.h"

namespace rds {
namespace {

// The small world, but something at 40 cm covers the lens in the first frames, in the mask too; it sways.
std::vector<SyntheticFrame> CoveredAtFirst(int covered) {
  std::vector<SyntheticFrame> frames = Frames(SyntheticScenario::kStatic);
  Random random(1);
  std::vector<std::uint8_t> texture(400 * 400);
  for (std::uint8_t& gray : texture) {
    gray = static_cast<std::uint8_t>(random.Index(256));
  }
  for (int i = 0; i < covered; ++i) {
    const PinholeCamera camera = MakeSyntheticCamera(320, 240);
    auto image = std::make_shared<Image8>(camera.width, camera.height);
    const int sway = 3 * (i % 6 < 3 ? i % 3 : 3 - i % 3);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        image->At(x, y) = texture[static_cast<std::size_t>((y / 4) * 400 + (x + sway) / 4)];
      }
    }
    SyntheticFrame& frame = frames[static_cast<std::size_t>(i)];
    frame.rgbd.image = std::move(image);
    frame.rgbd.depth =
        std::make_shared<Image16>(camera.width, camera.height, 1, static_cast<std::uint16_t>(0.4 * camera.depth_scale));
    frame.mask = std::make_shared<Image8>(camera.width, camera.height, 1, 255);
  }
  return frames;
}

TEST(Startup, AMapBeginsWithTheFirstFrameThatShowsSomethingStatic) {
  constexpr int kCovered = 15;
  const std::vector<SyntheticFrame> frames = CoveredAtFirst(kCovered);
  Options options = SmallOptions(true);
  options.semantic.lockstep_delay_frames = 4;
  const SlamResult result = RunAll(frames, options, TrueMasks(frames));
  // A label is asked for every five frames or so until one leaves enough.
  EXPECT_GE(result.tracked_frames, kFrames - kCovered - 6);
  EXPECT_LE(result.tracked_frames, kFrames - kCovered);
  EXPECT_LT(AteRmse(result, frames), 0.01);
}

TEST(Startup, AMapThatIsLostYoungBeginsAnew) {
  constexpr int kCovered = 8;
  const std::vector<SyntheticFrame> frames = CoveredAtFirst(kCovered);
  for (const bool lockstep : {true, false}) {
    const SlamResult result = RunAll(frames, SmallOptions(lockstep), nullptr);
    EXPECT_GE(result.tracked_frames, kFrames - kCovered - 8) << lockstep;
    EXPECT_LT(AteRmse(result, frames), 0.01) << lockstep;
  }
}

TEST(Startup, FramesWithoutWhatAMapNeedsDoNotEndOne) {
  std::vector<SyntheticFrame> frames = Frames(SyntheticScenario::kStatic);
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  for (std::size_t i = 10; i < 20; ++i) {  // lost for as long as it was tracked, in the dark
    frames[i].rgbd.image = std::make_shared<Image8>(camera.width, camera.height);
  }
  const SlamResult result = RunAll(frames, SmallOptions(true), nullptr);
  EXPECT_EQ(result.tracked_frames, kFrames - 10);
  EXPECT_LT(AteRmse(result, frames), 0.02);
}

}  // namespace
}  // namespace rds
