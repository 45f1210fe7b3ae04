// SPDX-License-Identifier: Apache-2.0
// End to end on a synthetic world: accuracy, lockstep, bad input, shutdown in every state.
#include "system/slam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "base/error.h"
#include "testing/fake_segmenter.h"
#include "testing/small_world.h"

namespace rds {
namespace {

bool SameBytes(const Trajectory& a, const Trajectory& b) {
  if (a.size() != b.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::memcmp(a[i].world_from_camera.translation.data(), b[i].world_from_camera.translation.data(),
                    3 * sizeof(double)) != 0 ||
        std::memcmp(a[i].world_from_camera.rotation.coeffs().data(), b[i].world_from_camera.rotation.coeffs().data(),
                    4 * sizeof(double)) != 0) {
      return false;
    }
  }
  return true;
}

TEST(Slam, TracksAStaticWorldInLockstep) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  const SlamResult result = RunAll(frames, SmallOptions(true), nullptr);
  EXPECT_EQ(result.processed_frames, kFrames);
  EXPECT_EQ(result.tracked_frames, kFrames);
  EXPECT_EQ(result.lost_frames, 0);
  EXPECT_GE(result.keyframes.size(), 1U);
  EXPECT_EQ(result.labels.size(), 0U);
  EXPECT_LT(AteRmse(result, frames), 0.02);
}

TEST(Slam, LockstepGivesTheSameBytesTwice) {
  const auto& frames = Frames(SyntheticScenario::kWalking);
  const SlamResult first = RunAll(frames, SmallOptions(true), TrueMasks(frames));
  const SlamResult second = RunAll(frames, SmallOptions(true), TrueMasks(frames));
  EXPECT_GT(first.labels.size(), 2U);
  EXPECT_TRUE(SameBytes(first.frames, second.frames));
  EXPECT_TRUE(SameBytes(first.keyframes, second.keyframes));
}

TEST(Slam, TracksThreaded) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  const SlamResult result = RunAll(frames, SmallOptions(false), TrueMasks(frames));
  EXPECT_EQ(result.tracked_frames, kFrames);
  EXPECT_LT(AteRmse(result, frames), 0.03);
}

TEST(Slam, EndsWithoutFinishInEveryState) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  for (const std::size_t count : {0U, 1U, 2U, 10U}) {
    Slam slam(
        MakeSyntheticCamera(320, 240), SmallOptions(false),
        std::make_unique<FaultySegmenter>("never answers", std::nullopt, [](auto) { return std::vector<Image8>{}; }));
    for (std::size_t i = 0; i < count; ++i) {
      static_cast<void>(slam.Process(frames[i].rgbd));
    }
  }
}

TEST(Slam, FinishWithoutFramesIsEmpty) {
  Slam slam(MakeSyntheticCamera(320, 240), SmallOptions(false));
  const SlamResult result = FinishValid(slam);
  EXPECT_EQ(result.processed_frames, 0);
  EXPECT_TRUE(result.frames.empty());
  EXPECT_TRUE(result.keyframes.empty());
}

TEST(Slam, RefusesBadFramesAndStaysUsable) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  Slam slam(MakeSyntheticCamera(320, 240), SmallOptions(true));
  EXPECT_EQ(slam.Process(frames[0].rgbd).state, TrackingState::kTracked);
  EXPECT_THROW(static_cast<void>(slam.Process(frames[0].rgbd)), InputError);  // the same timestamp
  RgbdFrame bad = frames[1].rgbd;
  bad.depth = std::make_shared<const Image16>(160, 120);
  EXPECT_THROW(static_cast<void>(slam.Process(bad)), InputError);
  bad.depth = nullptr;
  EXPECT_THROW(static_cast<void>(slam.Process(bad)), InputError);
  bad = frames[1].rgbd;
  bad.timestamp_s = std::nan("");
  EXPECT_THROW(static_cast<void>(slam.Process(bad)), InputError);
  EXPECT_EQ(slam.Process(frames[1].rgbd).state, TrackingState::kTracked);
}

TEST(Slam, BlackFramesAreLostAndTrackingIsRecovered) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  Slam slam(MakeSyntheticCamera(320, 240), SmallOptions(true));
  int lost = 0;
  for (int i = 0; i < kFrames; ++i) {
    RgbdFrame frame = frames[static_cast<std::size_t>(i)].rgbd;
    if (i >= 20 && i < 25) {
      frame.image = std::make_shared<const Image8>(320, 240, 3);
    }
    const FrameResult result = slam.Process(frame);
    EXPECT_EQ(result.world_from_camera.has_value(), result.state == TrackingState::kTracked);
    lost += result.state == TrackingState::kLost ? 1 : 0;
    if (i == kFrames - 1) {
      EXPECT_EQ(result.state, TrackingState::kTracked);
    }
  }
  EXPECT_GE(lost, 5);
  const SlamResult result = FinishValid(slam);
  EXPECT_EQ(result.lost_frames, lost);
  EXPECT_EQ(result.tracked_frames, kFrames - lost);
  EXPECT_LT(AteRmse(result, frames), 0.02);
}

// Gray, one half averaged over squares of 7 pixels, the other black.
Image8 HalfBlurred(const Image8& image, bool left) {
  constexpr int kReach = 3;
  const int half = image.width / 2;
  Image8 blurred(image.width, image.height);
  for (int y = kReach; y < image.height - kReach; ++y) {
    for (int x = (left ? 0 : half) + kReach; x < (left ? half : image.width) - kReach; ++x) {
      int sum = 0;
      for (int dy = -kReach; dy <= kReach; ++dy) {
        for (int dx = -kReach; dx <= kReach; ++dx) {
          sum += image.At(x + dx, y + dy);
        }
      }
      blurred.At(x, y) = static_cast<std::uint8_t>(sum / ((2 * kReach + 1) * (2 * kReach + 1)));
    }
  }
  return blurred;
}

// Neither the frame before nor the reference keyframe tells where the camera is: only the map, where it is expected.
TEST(Slam, BlurredPartsOfThePictureThatTakeTurnsAreTracked) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  Slam slam(MakeSyntheticCamera(320, 240), SmallOptions(true));
  int lost = 0;
  for (int i = 0; i < kFrames; ++i) {
    RgbdFrame frame = frames[static_cast<std::size_t>(i)].rgbd;
    if (i >= 20 && i < 28) {
      frame.image = std::make_shared<Image8>(HalfBlurred(*frame.image, i % 2 == 0));
    }
    lost += slam.Process(frame).state == TrackingState::kLost ? 1 : 0;
  }
  EXPECT_EQ(lost, 0);
  EXPECT_LT(AteRmse(FinishValid(slam), frames), 0.02);
}

TEST(Slam, WithoutDepthOrBeyondItsRangeNothingIsInvented) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  for (const std::uint16_t depth : {std::uint16_t{0}, std::uint16_t{65535}}) {
    Slam slam(MakeSyntheticCamera(320, 240), SmallOptions(false));
    for (int i = 0; i < 10; ++i) {
      RgbdFrame frame = frames[static_cast<std::size_t>(i)].rgbd;
      frame.depth = std::make_shared<const Image16>(320, 240, 1, depth);
      EXPECT_EQ(slam.Process(frame).state, TrackingState::kNotInitialized) << depth;
    }
    EXPECT_EQ(FinishValid(slam).tracked_frames, 0);
  }
}

}  // namespace
}  // namespace rds
