// SPDX-License-Identifier: Apache-2.0
// What goes wrong inside ends a run in words, with what it has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/time.h"
#include "system/slam.h"
#include "testing/small_world.h"

namespace rds {
namespace {

// Breaks the thread that it runs on: even the report of its failure fails.
class BreakingSegmenter final : public Segmenter {
 public:
  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> /*inputs*/) override {
    throw std::runtime_error("no label");
  }
  void Cancel() override {}
  [[nodiscard]] std::string Name() const override { throw std::logic_error("no name either"); }
};

TEST(Slam, AnErrorOfAThreadInsideEndsTheRunAndKeepsWhatWasTracked) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  for (const bool lockstep : {true, false}) {
    Options options = SmallOptions(lockstep);
    options.system.wait_for_mapping = true;
    Slam slam(MakeSyntheticCamera(320, 240), options, std::make_unique<BreakingSegmenter>());
    int tracked = 0;
    const Stopwatch watch;
    std::string error;
    for (const auto& frame : frames) {
      try {
        tracked += slam.Process(frame.rgbd).state == TrackingState::kTracked ? 1 : 0;
      } catch (const std::logic_error& caught) {
        error = caught.what();
        break;
      }
    }
    EXPECT_EQ(error, "no name either");
    RgbdFrame later = frames.back().rgbd;
    later.timestamp_s += 1;
    EXPECT_THROW(static_cast<void>(slam.Process(later)), std::logic_error) << "and from then on";
    const Stopwatch finish;
    const SlamResult result = FinishValid(slam);
    EXPECT_LT(finish.Seconds(), 1);
    EXPECT_EQ(static_cast<int>(result.frames.size()), tracked);
    EXPECT_EQ(result.tracked_frames, tracked);
    EXPECT_GT(tracked, 0);
    ASSERT_NE(result.error, nullptr);
    EXPECT_THROW(std::rethrow_exception(result.error), std::logic_error);
    EXPECT_LT(watch.Seconds(), 30);
  }
}

TEST(Slam, OptionsOutOfRangeAreRefusedBeforeAnythingIsMadeOfThem) {
  const auto error_with = [](auto change) {
    Options options = SmallOptions(true);
    change(options);
    try {
      const Slam slam(MakeSyntheticCamera(320, 240), options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_with([](Options& options) { options.orb.levels = 0; }), testing::HasSubstr("orb.levels"));
  EXPECT_THAT(error_with([](Options& options) { options.orb.features = -5; }), testing::HasSubstr("orb.features"));
  EXPECT_THAT(error_with([](Options& options) { options.system.keyframe_queue = -1; }),
              testing::HasSubstr("system.keyframe_queue"));
  EXPECT_THAT(error_with([](Options& options) {
                options.orb.features = 10000;
                options.orb.moving_ratio = 10;
              }),
              testing::HasSubstr("must not be above 65000"));
}

TEST(Slam, ACameraThatCannotBeUndistortedIsRefused) {
  PinholeCamera camera = MakeSyntheticCamera(320, 240);
  camera.distortion = {1e6, 1e6, 1e3, 1e3, 1e9};
  EXPECT_THROW(Slam(camera, SmallOptions(true)), InputError);
  camera.distortion = {0.1, -0.2, 0.001, 0.001, 0.05};
  EXPECT_NO_THROW(Slam(camera, SmallOptions(true)));
}

TEST(Slam, ViewsOfTheMapComeAsItGrowsAndOnlyWhereTheyAreWanted) {
  const auto& frames = Frames(SyntheticScenario::kStatic);
  for (const bool wanted : {true, false}) {
    Options options = SmallOptions(true);
    options.system.keep_features = wanted;
    Slam slam(MakeSyntheticCamera(320, 240), options, TrueMasks(frames));
    EXPECT_TRUE(slam.ViewMap()->points.empty());
    for (std::size_t i = 0; i < 20; ++i) {
      static_cast<void>(slam.Process(frames[i].rgbd));
    }
    EXPECT_EQ(slam.ViewMap()->points.size() > 100, wanted);
    EXPECT_EQ(slam.ViewMap()->points.size(), slam.ViewMap()->moving_probability.size());
    const auto before = slam.ViewMap();
    EXPECT_EQ(before == slam.ViewMap(), wanted) << "a pointer, not a copy";
    EXPECT_GT(FinishValid(slam).map.points.size(), 100U);
  }
}

}  // namespace
}  // namespace rds
