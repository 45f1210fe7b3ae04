// End to end on a synthetic world: accuracy, lockstep, back ends that fail, bad input, shutdown in every state.
#include "system/slam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "base/time.h"
#include "geometry/alignment.h"
#include "semantic/faulty_segmenter.h"
#include "testing/synthetic_world.h"

namespace rds {
namespace {

constexpr int kFrames = 45;

SyntheticOptions SmallWorld(SyntheticScenario scenario) {
  SyntheticOptions options;
  options.camera = MakeSyntheticCamera(320, 240);
  options.scenario = scenario;
  options.frames = kFrames;
  return options;
}

std::vector<SyntheticFrame> Rendered(const SyntheticOptions& options) {
  const SyntheticWorld world(options);
  std::vector<SyntheticFrame> frames;
  for (int i = 0; i < world.frame_count(); ++i) {
    frames.push_back(world.Render(i));
  }
  return frames;
}

// Rendered once for all tests.
const std::vector<SyntheticFrame>& Frames(SyntheticScenario scenario) {
  if (scenario == SyntheticScenario::kStatic) {
    static const std::vector<SyntheticFrame> still = Rendered(SmallWorld(SyntheticScenario::kStatic));
    return still;
  }
  static const std::vector<SyntheticFrame> walking = Rendered(SmallWorld(SyntheticScenario::kWalking));
  return walking;
}

// Masks of the world itself, as a back end that makes no mistakes.
std::unique_ptr<Segmenter> TrueMasks(const std::vector<SyntheticFrame>& frames) {
  return std::make_unique<FaultySegmenter>("true masks", std::chrono::milliseconds(0),
                                           [&frames](std::span<const SegmentationInput> inputs) {
                                             std::vector<Image8> masks;
                                             for (const SegmentationInput& input : inputs) {
                                               masks.push_back(*frames[input.frame.index()].mask);
                                             }
                                             return masks;
                                           });
}

std::vector<Image8> Filled(std::span<const SegmentationInput> inputs, int width, int height, std::uint8_t value) {
  return std::vector<Image8>(inputs.size(), Image8(width, height, 1, value));
}

Options SmallOptions(bool lockstep) {
  Options options;
  options.system.lockstep = lockstep;
  options.system.wait_for_mapping = true;
  options.semantic.finish_timeout_s = 0.3;
  options.semantic.cancel_timeout_s = 0.3;
  options.tracking.min_start_points = 50;
  return options;
}

SlamResult RunAll(const std::vector<SyntheticFrame>& frames, const Options& options,
                  std::unique_ptr<Segmenter> segmenter) {
  Slam slam(MakeSyntheticCamera(320, 240), options, std::move(segmenter));
  for (const SyntheticFrame& frame : frames) {
    static_cast<void>(slam.Process(frame.rgbd));
  }
  return slam.Finish();
}

double AteRmse(const SlamResult& result, const std::vector<SyntheticFrame>& frames) {
  std::vector<Eigen::Vector3d> estimate;
  std::vector<Eigen::Vector3d> truth;
  for (const StampedPose& pose : result.frames) {
    for (const SyntheticFrame& frame : frames) {
      if (std::abs(frame.rgbd.timestamp_s - pose.timestamp_s) < 1e-6) {
        estimate.push_back(pose.world_from_camera.translation);
        truth.push_back(frame.world_from_camera.translation);
      }
    }
  }
  const Alignment alignment = Align(estimate, truth, false);
  double sum = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    sum += (alignment.Apply(estimate[i]) - truth[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(estimate.size()));
}

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

TEST(Slam, LabelsEachKeyframeOnceAndLabelsSayWhatIsStatic) {
  const auto& frames = Frames(SyntheticScenario::kWalking);
  const SlamResult result = RunAll(frames, SmallOptions(true), TrueMasks(frames));
  std::vector<std::uint32_t> labelled;
  for (const LabelEvent& event : result.labels) {
    labelled.push_back(event.labelled_frame.value);
  }
  std::ranges::sort(labelled);
  EXPECT_TRUE(std::ranges::adjacent_find(labelled) == labelled.end());
  EXPECT_EQ(labelled.front(), 0U);  // the very first keyframe too
  EXPECT_EQ(result.keyframes_left_unlabelled, 0);
  EXPECT_GT(result.static_points, result.unknown_points);
  EXPECT_LT(AteRmse(result, frames), 0.05);
}

// People stand close to the camera from the start, then walk together: without semantics the map goes with them.
TEST(Slam, SemanticsKeepThoseWhoWalkTogetherOutOfTheMap) {
  SyntheticOptions synthetic = SmallWorld(SyntheticScenario::kWalking);
  synthetic.frames = 120;
  const std::vector<SyntheticFrame> frames = Rendered(synthetic);
  Options options = SmallOptions(true);
  options.semantic.lockstep_delay_frames = 6;  // 200 ms
  const SlamResult without = RunAll(frames, options, nullptr);
  const SlamResult with = RunAll(frames, options, TrueMasks(frames));
  EXPECT_EQ(with.tracked_frames, synthetic.frames);
  EXPECT_LT(AteRmse(with, frames), 0.02);
  EXPECT_GT(AteRmse(without, frames), 5 * AteRmse(with, frames));
}

TEST(Slam, TheMapGrowsWithTheFirstLabelOrWhenItIsOverdue) {
  const auto& frames = Frames(SyntheticScenario::kWalking);
  const auto frames_alone = [&](int delay_frames, int start_frames) {
    Options options = SmallOptions(true);
    options.semantic.lockstep_delay_frames = delay_frames;
    options.semantic.start_frames = start_frames;
    options.tracking.policy.min_frames = 0;
    Slam slam(MakeSyntheticCamera(320, 240), options, TrueMasks(frames));
    int alone = 0;
    for (const SyntheticFrame& frame : frames) {
      alone += slam.Process(frame.rgbd).keyframes_in_map == 1 ? 1 : 0;
    }
    return alone;
  };
  EXPECT_NEAR(frames_alone(8, 30), 9, 2);    // the label of the first keyframe comes after 9 frames
  EXPECT_NEAR(frames_alone(1000, 6), 6, 2);  // it does not come
  EXPECT_LE(frames_alone(1000, 0), 3);       // nobody waits
}

// A camera that stands still before a sloping wall; past it goes a board with more features than are left of the wall.
std::vector<SyntheticFrame> BoardPassing() {
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  const auto noise = [&](std::uint64_t seed) {
    Random random(seed);
    Image8 image(camera.width, camera.height);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        image.At(x, y) = y % 4 != 0   ? image.At(x, y - 1)
                         : x % 4 != 0 ? image.At(x - 1, y)
                                      : static_cast<std::uint8_t>(random.Index(256));
      }
    }
    return image;
  };
  const Image8 wall = noise(1);
  const Image8 board = noise(2);
  std::vector<SyntheticFrame> frames;
  for (int i = 0; i < kFrames; ++i) {
    auto image = std::make_shared<Image8>(wall);
    auto depth = std::make_shared<Image16>(camera.width, camera.height);
    auto mask = std::make_shared<Image8>(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const int on_board = x - 2 * i;
        const bool covered = on_board >= 10 && on_board < 220 && y >= 15 && y < 225;
        depth->At(x, y) = static_cast<std::uint16_t>((covered ? 1.5 : 4.0 - y / 120.0) * camera.depth_scale);
        mask->At(x, y) = covered ? 255 : 0;
        if (covered) {
          image->At(x, y) = board.At(on_board, y);
        }
      }
    }
    frames.push_back({{i / 30.0, std::move(image), std::move(depth)}, std::move(mask), {}});
  }
  return frames;
}

TEST(Slam, FramesBeforeTheFirstLabelAreTrackedAgainWithIt) {
  const std::vector<SyntheticFrame> frames = BoardPassing();
  const auto furthest_m = [&](int start_frames) {
    Options options = SmallOptions(true);
    options.semantic.lockstep_delay_frames = 15;
    options.semantic.start_frames = start_frames;
    const SlamResult result = RunAll(frames, options, TrueMasks(frames));
    EXPECT_EQ(result.tracked_frames, kFrames);
    double furthest = 0;
    for (const StampedPose& pose : std::span(result.frames).first(15)) {
      furthest = std::max(furthest, pose.world_from_camera.translation.norm());
    }
    return furthest;
  };
  EXPECT_LT(furthest_m(30), 0.03);
  EXPECT_GT(furthest_m(0), 0.1);  // went along with the board
}

TEST(Slam, TracksThreaded) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  const SlamResult result = RunAll(frames, SmallOptions(false), TrueMasks(frames));
  EXPECT_EQ(result.tracked_frames, kFrames);
  EXPECT_LT(AteRmse(result, frames), 0.03);
}

struct Failure {
  const char* name;
  std::optional<std::chrono::milliseconds> delay;
  FaultySegmenter::Answer answer;
  bool counted;  // as a failure of segmentation
};

class SlamWithFailingSegmenter : public testing::TestWithParam<Failure> {};

TEST_P(SlamWithFailingSegmenter, GoesOnAndEndsInTime) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  const Stopwatch watch;
  const SlamResult result =
      RunAll(frames, SmallOptions(false),
             std::make_unique<FaultySegmenter>(GetParam().name, GetParam().delay, GetParam().answer));
  EXPECT_EQ(result.tracked_frames, kFrames);
  EXPECT_LT(AteRmse(result, frames), 0.03);
  // A slow answer may come in time where the run itself is slower still, under a sanitizer say.
  const bool in_time = GetParam().delay && *GetParam().delay > std::chrono::milliseconds(0) &&
                       watch.Seconds() > std::chrono::duration<double>(*GetParam().delay).count();
  EXPECT_TRUE(result.labels.empty() || in_time);
  EXPECT_EQ(result.segmentation_failures > 0, GetParam().counted);
  EXPECT_LT(watch.Seconds(), 60);
}

INSTANTIATE_TEST_SUITE_P(
    Slam, SlamWithFailingSegmenter,
    testing::Values(
        Failure{"throws", std::chrono::milliseconds(0),
                [](auto) -> std::vector<Image8> { throw std::runtime_error("out of order"); }, true},
        Failure{"takes ten seconds", std::chrono::seconds(10), [](auto inputs) { return Filled(inputs, 320, 240, 0); },
                false},
        Failure{"never answers", std::nullopt, [](auto inputs) { return Filled(inputs, 320, 240, 0); }, false},
        Failure{"wrong size", std::chrono::milliseconds(0), [](auto inputs) { return Filled(inputs, 31, 24, 0); },
                true},
        Failure{"all ones", std::chrono::milliseconds(0), [](auto inputs) { return Filled(inputs, 320, 240, 255); },
                true},
        Failure{"too few masks", std::chrono::milliseconds(0), [](auto) { return std::vector<Image8>{}; }, false}),
    [](const auto& instance) {
      std::string name = instance.param.name;
      std::ranges::replace(name, ' ', '_');
      return name;
    });

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
  const SlamResult result = slam.Finish();
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

TEST(Slam, BlackFramesAreLostAndTrackingIsRegained) {
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
  const SlamResult result = slam.Finish();
  EXPECT_EQ(result.lost_frames, lost);
  EXPECT_EQ(result.tracked_frames, kFrames - lost);
  EXPECT_LT(AteRmse(result, frames), 0.02);
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
    EXPECT_EQ(slam.Finish().tracked_frames, 0);
  }
}

}  // namespace
}  // namespace rds
