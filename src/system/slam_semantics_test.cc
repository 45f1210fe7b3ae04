// SPDX-License-Identifier: Apache-2.0
// Semantics end to end on a synthetic world: what labels are good for, when they come, and back ends that fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/random.h"
#include "base/time.h"
#include "segmentation/unsure_segmenter.h"
#include "testing/small_world.h"

namespace rds {
namespace {

std::vector<Image8> Filled(std::span<const SegmentationInput> inputs, int width, int height, std::uint8_t value) {
  return std::vector<Image8>(inputs.size(), Image8(width, height, 1, value));
}

TEST(Slam, LabelsEachKeyframeOnceAndLabelsSayWhatIsStatic) {
  const auto& frames = Frames(SyntheticScenario::kWalking);
  const SlamResult result = RunAll(frames, SmallOptions(true), TrueMasks(frames));
  std::vector<std::uint32_t> labeled;
  for (const LabelEvent& event : result.labels) {
    labeled.push_back(event.labeled_frame.value);
  }
  std::ranges::sort(labeled);
  EXPECT_TRUE(std::ranges::adjacent_find(labeled) == labeled.end());
  EXPECT_EQ(labeled.front(), 0U);  // the very first keyframe too
  EXPECT_EQ(result.keyframes_left_unlabeled, 0);
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
    options.semantic.motion = false;
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

constexpr int kBoardFrames = 45;

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
  for (int i = 0; i < kBoardFrames; ++i) {
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
  const auto run = [&](bool motion) {
    Options options = SmallOptions(true);
    options.semantic.lockstep_delay_frames = 15;
    options.semantic.start_frames = 30;
    options.semantic.motion = motion;
    return RunAll(frames, options, TrueMasks(frames));
  };
  const auto furthest_m = [](const SlamResult& result) {
    double furthest = 0;
    for (const StampedPose& pose : std::span(result.frames).first(15)) {
      furthest = std::max(furthest, pose.world_from_camera.translation.norm());
    }
    return furthest;
  };
  for (const bool motion : {false, true}) {
    const SlamResult again = run(motion);
    EXPECT_EQ(again.tracked_frames, kBoardFrames);
    EXPECT_LT(furthest_m(again), 0.03);
  }
  // Where nobody waits, tracking goes along with the board until the label comes.
  Options options = SmallOptions(true);
  options.semantic.lockstep_delay_frames = 15;
  options.semantic.start_frames = 0;
  Slam slam(MakeSyntheticCamera(320, 240), options, TrueMasks(frames));
  double furthest = 0;
  for (const SyntheticFrame& frame : std::span(frames).first(15)) {
    const FrameResult result = slam.Process(frame.rgbd);
    furthest = std::max(furthest, result.world_from_camera ? result.world_from_camera->translation.norm() : 0);
  }
  EXPECT_GT(furthest, 0.1);
}

// In threads, the first label comes between two frames or at any moment while one is tracked.
TEST(Slam, FramesBeforeTheFirstLabelAreTrackedAgainWhateverTheMomentItComes) {
  using Milliseconds = std::chrono::duration<double, std::milli>;
  constexpr std::size_t kBefore = 12;  // frames before its mask may come
  constexpr int kMoments = 16;
  const std::vector<SyntheticFrame> frames = BoardPassing();
  for (int moment = 0; moment < kMoments; ++moment) {
    std::promise<void> gate;
    auto masks = [&frames, open = gate.get_future().share()](std::span<const SegmentationInput> inputs) {
      open.wait();
      return TrueMasks(frames)->Segment(inputs);
    };
    Options options = SmallOptions(false);
    options.semantic.start_frames =
        1000;  // they come as fast as they can here: on a busy machine many before the label
    Slam slam(MakeSyntheticCamera(320, 240), options,
              std::make_unique<FaultySegmenter>("held back", std::chrono::milliseconds(0), std::move(masks)));
    double frame_ms = 0;
    for (std::size_t i = 0; i < kBefore; ++i) {
      frame_ms = slam.Process(frames[i].rgbd).timing.total_ms;
    }
    // From two frames' time before the next frame to its end: between mask and label lies some work.
    std::thread opener([&, wait = Milliseconds(3 * frame_ms * moment / kMoments)] {
      std::this_thread::sleep_for(wait);
      gate.set_value();
    });
    std::this_thread::sleep_for(Milliseconds(2 * frame_ms));
    std::size_t next = kBefore;
    while (next < frames.size() && !slam.Process(frames[next++].rgbd).semantic_delay_frames) {
    }
    opener.join();
    ASSERT_LT(next, frames.size()) << "no label came";
    static_cast<void>(slam.Process(frames[next].rgbd));  // tracks the frames before the label again, if not done yet
    const SlamResult result = FinishValid(slam);
    ASSERT_GE(result.frames.size(), kBefore);
    for (const StampedPose& pose : std::span(result.frames).first(kBefore)) {
      EXPECT_LT(pose.world_from_camera.translation.norm(), 0.03) << "moment " << moment;
    }
  }
}

// A board with more corners than the rest, carried before the camera from the first frame on: no network knows it.
TEST(Slam, WhatMovesNeedsNoName) {
  SyntheticOptions synthetic = SmallWorld(SyntheticScenario::kCarried);
  synthetic.path = SyntheticPath::kLoop;
  synthetic.frames = 120;
  const std::vector<SyntheticFrame> frames = Rendered(synthetic);
  const SlamResult without = RunAll(frames, SmallOptions(true), nullptr);
  const SlamResult with = RunAll(frames, SmallOptions(true), std::make_unique<UnsureSegmenter>());
  EXPECT_EQ(with.tracked_frames, synthetic.frames);
  EXPECT_LT(AteRmse(with, frames), 0.02);
  EXPECT_GT(AteRmse(without, frames), 10 * AteRmse(with, frames));
  // In threads, as fast as they go, labels come when they come.
  const SlamResult threaded = RunAll(frames, SmallOptions(false), std::make_unique<UnsureSegmenter>());
  EXPECT_EQ(threaded.tracked_frames, synthetic.frames);
  EXPECT_LT(AteRmse(threaded, frames), AteRmse(without, frames) / 2);
}

// Metrics 6 and 7 of the paper: keyframes that come faster than their masks.
TEST(Slam, SequentialLabelsFallFartherAndFartherBehindAndBidirectionalOnesDoNot) {
  SyntheticOptions synthetic = SmallWorld(SyntheticScenario::kWalking);
  synthetic.frames = 66;  // then the camera comes to rest, and keyframes with it
  const std::vector<SyntheticFrame> frames = Rendered(synthetic);
  const auto delays_in = [&](SelectionMode selection) {
    Options options = SmallOptions(true);
    options.semantic.selection = selection;
    options.semantic.lockstep_delay_frames = 6;     // two masks in six frames
    options.tracking.policy.depth_tracked = 10000;  // each frame wants to be a keyframe
    options.tracking.policy.depth_untracked = 0;
    options.semantic.start_frames = 0;
    Slam slam(MakeSyntheticCamera(320, 240), options, TrueMasks(frames));
    std::vector<int> delays;
    for (const SyntheticFrame& frame : frames) {
      delays.push_back(slam.Process(frame.rgbd).semantic_delay_frames.value_or(0));
    }
    const auto median = [&](std::size_t from) {
      std::vector<int> third(delays.begin() + static_cast<std::ptrdiff_t>(from),
                             delays.begin() + static_cast<std::ptrdiff_t>(from + frames.size() / 3));
      std::ranges::nth_element(third, third.begin() + std::ssize(third) / 2);
      return third[third.size() / 2];
    };
    return std::array{median(0), median(frames.size() / 3), median(2 * frames.size() / 3)};
  };
  // Two masks for six keyframes: fourteen frames more in a third, fewer where keyframes turn out redundant.
  const auto [sequential_first, sequential_then, sequential_later] = delays_in(SelectionMode::kSequential);
  EXPECT_GT(sequential_then, sequential_first + 10);
  EXPECT_GT(sequential_later, sequential_then + 10);
  EXPECT_GT(sequential_later, 25);
  const auto [first, bidirectional_then, bidirectional_later] = delays_in(SelectionMode::kBidirectional);
  EXPECT_LE(bidirectional_later, bidirectional_then + 2);
  EXPECT_LE(bidirectional_later, 14);  // two rounds of six frames, and two
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
        Failure{"too few masks", std::chrono::milliseconds(0), [](auto) { return std::vector<Image8>{}; }, true}),
    [](const auto& instance) {
      std::string name = instance.param.name;
      std::ranges::replace(name, ' ', '_');
      return name;
    });

// A back end that hears nothing: neither that it is to give up nor anything else.
class DeafSegmenter final : public Segmenter {
 public:
  DeafSegmenter(std::shared_future<void> wake_up, std::promise<void> gone)
      : wake_up_(std::move(wake_up)), gone_(std::move(gone)) {}
  ~DeafSegmenter() override { gone_.set_value(); }

  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    wake_up_.wait();
    return std::vector<Image8>(inputs.size());
  }
  void Cancel() override {}
  [[nodiscard]] std::string Name() const override { return "deaf"; }

 private:
  std::shared_future<void> wake_up_;
  std::promise<void> gone_;
};

// The frames before the first label are tracked again; whoever adds up motion must not go that way twice.
TEST(Slam, OdometryGoesEachWayOnceInLockstep) {
  const auto& frames = Frames(SyntheticScenario::kWalking);
  Slam slam(MakeSyntheticCamera(320, 240), SmallOptions(true), TrueMasks(frames));
  std::vector<FrameResult> results;
  for (const SyntheticFrame& frame : frames) {
    results.push_back(slam.Process(frame.rgbd));
  }
  const SlamResult result = FinishValid(slam);
  ASSERT_EQ(result.frames.size(), frames.size());
  for (std::size_t i = 1; i < results.size(); ++i) {
    ASSERT_TRUE(results[i].odometry_from_camera.has_value()) << i;
    const auto motion = [&](const Rigid3& before, const Rigid3& now) { return before.Inverse() * now; };
    const Rigid3 odometry = motion(*results[0].odometry_from_camera, *results[i].odometry_from_camera);
    const Rigid3 truth = motion(frames[0].world_from_camera, frames[i].world_from_camera);
    EXPECT_LT((odometry.translation - truth.translation).norm(), 0.05) << i;
  }
}

TEST(Slam, EndsWithoutABackEndThatDoesNotGiveUp) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  std::promise<void> wake_up;
  std::promise<void> gone;
  std::future<void> is_gone = gone.get_future();
  const Stopwatch watch;
  const SlamResult result =
      RunAll(frames, SmallOptions(false), std::make_unique<DeafSegmenter>(wake_up.get_future(), std::move(gone)));
  EXPECT_LT(watch.Seconds(), 60);
  EXPECT_EQ(result.tracked_frames, kFrames);
  EXPECT_TRUE(result.labels.empty());
  EXPECT_GT(result.keyframes_left_unlabeled, 0);
  // Its thread lives on with all that it may touch; when it comes back, both end.
  EXPECT_EQ(is_gone.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  wake_up.set_value();
  EXPECT_EQ(is_gone.wait_for(std::chrono::seconds(30)), std::future_status::ready);
}

}  // namespace
}  // namespace rds
