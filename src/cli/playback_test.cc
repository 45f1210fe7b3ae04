// SPDX-License-Identifier: Apache-2.0
#include "cli/playback.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "base/error.h"
#include "cli/frame_source.h"
#include "cli/interrupt.h"
#include "synth/synthetic_sequence.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kFrames = 20;

// A short sequence without people, written once; a test that breaks it works on a copy.
class PlaybackTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    sequence_ = folder_->path() / "sequence";
    SyntheticOptions options;
    options.camera = MakeSyntheticCamera(320, 240);
    options.scenario = SyntheticScenario::kStatic;
    options.frames = kFrames;
    const SyntheticWorld world(options);
    camera_ = world.camera();
    WriteSyntheticSequence(world, sequence_);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path CopyOfSequence() {
    const fs::path copy = folder_->path() / "copy";
    fs::copy(sequence_, copy, fs::copy_options::recursive);
    return copy;
  }

  static PlaybackResult PlayAll(double rate, std::span<PlaybackObserver* const> observers = {}) {
    return Play(Dataset::Open(sequence_), camera_, Lockstep(), nullptr, {.rate = rate}, observers);
  }

  static Options Lockstep() {
    Options options;
    options.system.lockstep = true;
    return options;
  }
  void TearDown() override { fs::remove_all(folder_->path() / "copy"); }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static fs::path sequence_;
  inline static PinholeCamera camera_;
};

// Stops the run by a signal after some frames.
class Interrupter final : public PlaybackObserver {
 public:
  explicit Interrupter(int frames) : left_(frames) {}
  void AfterFrame(const RgbdFrame& /*frame*/, const FrameResult& /*result*/, const Slam& /*slam*/) override {
    if (--left_ == 0) {
      raise(SIGINT);
    }
  }

 private:
  int left_;
};

// Keeps what it is told.
class Listener final : public PlaybackObserver {
 public:
  void OnEvent(const SlamEvent& event) override { events.push_back(event); }

  std::vector<SlamEvent> events;
};

TEST_F(PlaybackTest, ObserversAreToldWhatHappensToTheMap) {
  Listener listener;
  const std::vector<PlaybackObserver*> observers = {&listener};
  const PlaybackResult result = PlayAll(0, observers);
  ASSERT_EQ(listener.events.size(), 1U);
  EXPECT_EQ(listener.events[0].kind, SlamEventKind::kWorldStarted);
  EXPECT_EQ(listener.events[0].timestamp_s, result.frames.front().timestamp_s);
}

TEST_F(PlaybackTest, SourceGivesAllFramesInOrder) {
  const Dataset dataset = Dataset::Open(sequence_);
  FrameSource source(dataset, camera_);
  for (const DatasetFrame& expected : dataset.frames()) {
    const std::optional<SourceFrame> frame = source.Next();
    ASSERT_TRUE(frame && frame->frame);
    EXPECT_EQ(frame->frame->timestamp_s, expected.timestamp_s);
  }
  EXPECT_FALSE(source.Next().has_value());
  EXPECT_FALSE(source.Next().has_value());
  EXPECT_GT(source.CpuSeconds(), 0);
}

TEST_F(PlaybackTest, SourceCanBeLeftEarly) {
  const Dataset dataset = Dataset::Open(sequence_);
  FrameSource source(dataset, camera_);
  EXPECT_TRUE(source.Next().has_value());
}

TEST_F(PlaybackTest, AFrameThatCannotBeReadIsLeftOutOrStrictlyAnError) {
  const fs::path copy = CopyOfSequence();
  const Dataset dataset = Dataset::Open(copy);
  fs::resize_file(dataset.frames()[7].depth_path, 100);
  FrameSource source(dataset, camera_);
  for (std::size_t i = 0; i < dataset.size(); ++i) {
    const std::optional<SourceFrame> frame = source.Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->frame.has_value(), i != 7);
  }
  EXPECT_FALSE(source.Next());
  const PlaybackResult result = Play(dataset, camera_, Lockstep(), nullptr, {.rate = 0}, {});
  EXPECT_EQ(result.left_out, 1U);
  EXPECT_THAT(result.first_problem, HasSubstr(dataset.frames()[7].depth_path.filename().string()));
  EXPECT_EQ(result.frames.size(), static_cast<std::size_t>(kFrames - 1));
  EXPECT_EQ(result.slam.tracked_frames, kFrames - 1);
  EXPECT_EQ(result.error, nullptr);
  EXPECT_THROW((void)Play(dataset, camera_, Lockstep(), nullptr, {.rate = 0, .strict = true}, {}), InputError);
}

TEST_F(PlaybackTest, ReadingThatEndsForGoodKeepsWhatWasTracked) {
  const fs::path copy = CopyOfSequence();
  const Dataset dataset = Dataset::Open(copy);
  for (std::size_t i = 9; i < dataset.size(); ++i) {  // as if the drive had been pulled out
    fs::remove(dataset.frames()[i].color_path);
  }
  const PlaybackResult result = Play(dataset, camera_, Lockstep(), nullptr, {.rate = 0}, {});
  EXPECT_EQ(result.slam.tracked_frames, 9);
  EXPECT_THAT(InputErrorOf([&] { RethrowError(result); }), HasSubstr("reading ended for good at frame 9: 11 frames"));
  for (std::size_t i = 0; i < 9; ++i) {
    fs::remove(dataset.frames()[i].depth_path);
  }
  EXPECT_THROW((void)Play(dataset, camera_, Lockstep(), nullptr, {.rate = 0}, {}), InputError) << "nothing was read";
}

TEST_F(PlaybackTest, PausesOfTheRecordingAreCutToASecond) {
  const fs::path copy = CopyOfSequence();
  std::ofstream list(copy / "associations.txt");
  const Dataset whole = Dataset::Open(sequence_);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const DatasetFrame& frame = whole.frames()[i];
    const double time_s = frame.timestamp_s + (i >= 10 ? 3600 : 0);
    list << std::fixed << time_s << " " << frame.color_path << " " << time_s << " " << frame.depth_path << "\n";
  }
  list.close();
  const PlaybackResult result = Play(Dataset::Open(copy), camera_, Lockstep(), nullptr, {.rate = 2}, {});
  EXPECT_EQ(result.frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_GE(result.wall_s, 1);
  EXPECT_LT(result.wall_s, 30);
}

TEST_F(PlaybackTest, PlaysEveryFrame) {
  const PlaybackResult result = PlayAll(0);
  EXPECT_EQ(result.frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(result.start_delay_ms, std::vector<double>(kFrames, 0.0));
  EXPECT_EQ(result.slam.processed_frames, kFrames);
  EXPECT_EQ(result.slam.tracked_frames, kFrames);
  EXPECT_EQ(result.slam.frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_FALSE(result.interrupted);
  ASSERT_TRUE(result.first_pose_after_s.has_value());
  EXPECT_LT(*result.first_pose_after_s, result.wall_s);
  EXPECT_GT(result.cpu_s, result.reading_cpu_s);
  EXPECT_GT(result.reading_cpu_s, 0);
}

TEST_F(PlaybackTest, KeepsToTheRecordedTimes) {
  // 19 intervals of 1/30 s, at twice the speed. Only the lower bound is certain on a busy machine.
  EXPECT_GE(PlayAll(2).wall_s, 19 / 30.0 / 2);
}

TEST_F(PlaybackTest, CountsStartDelay) {
  const PlaybackResult result = PlayAll(1000);
  ASSERT_EQ(result.frames.size(), static_cast<std::size_t>(kFrames)) << "late frames are processed all the same";
  EXPECT_GT(result.start_delay_ms.back(), 0);
}

TEST_F(PlaybackTest, SignalStopsAndKeepsWhatWasTracked) {
  const InterruptGuard guard;
  Interrupter interrupter(8);
  const std::vector<PlaybackObserver*> observers = {&interrupter};
  const PlaybackResult result = PlayAll(0, observers);
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.frames.size(), 8U);
  EXPECT_EQ(result.slam.frames.size(), 8U);
}

TEST_F(PlaybackTest, SignalEndsALongWait) {
  const InterruptGuard guard;
  Interrupter interrupter(1);
  const std::vector<PlaybackObserver*> observers = {&interrupter};
  const PlaybackResult result = PlayAll(0.001, observers);  // the second frame would be due after half a minute
  EXPECT_TRUE(result.interrupted);
  EXPECT_LT(result.wall_s, 15);
}

}  // namespace
}  // namespace rds
