// SPDX-License-Identifier: Apache-2.0
#include "cli/playback.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <opencv2/core.hpp>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/time.h"
#include "cli/frame_source.h"
#include "cli/interrupt.h"

namespace rds {
namespace {

// When frames are due: the first when the clock starts, the others as much later as they were recorded, but for pauses.
class Schedule {
 public:
  Schedule(double rate, const Dataset& dataset)
      : rate_(rate), pause_s_(std::max(kLongestPause_s, 5 * dataset.MedianIntervalS())) {}

  // Waits until a frame is due; returns how late it is, in milliseconds. Returns early when interrupted.
  double Wait(double timestamp_s) {
    const double step_s = last_s_ ? timestamp_s - *last_s_ : 0;
    last_s_ = timestamp_s;
    if (rate_ == 0) {
      return 0;
    }
    double step_due_s = step_s / rate_;
    if (step_s > pause_s_ && step_due_s > kLongestPause_s) {
      log::info("the recording pauses for {:.1f} s after {:.3f} s; going on after {:g} s", step_s, timestamp_s - step_s,
                kLongestPause_s);
      step_due_s = kLongestPause_s;
    }
    due_s_ += step_due_s;
    double late_s = watch_.Seconds() - due_s_;
    while (late_s < 0 && !Interrupted()) {
      // In short pieces: a signal does not end a sleep.
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(-late_s, 0.05)));
      late_s = watch_.Seconds() - due_s_;
      if (late_s >= 0) {
        return 0;
      }
    }
    return std::max(0.0, 1e3 * late_s);
  }

 private:
  static constexpr double kLongestPause_s = 1;

  double rate_;
  double pause_s_;  // a step that is longer is none of the camera's usual ones
  std::optional<double> last_s_;
  double due_s_ = 0;
  Stopwatch watch_;
};

// Counts frames that cannot be read and says so; the first few in full.
class LeftOut {
 public:
  LeftOut(std::size_t frames, PlaybackResult& result) : frames_(frames), result_(result) {}

  void Read() {
    if (!any_read_ && result_.left_out > 0) {
      log::warn("{} frames at the beginning are left out; the first: {}", result_.left_out, result_.first_problem);
    }
    in_a_row_ = 0;
    any_read_ = true;
  }
  // Throws InputError where there is no point in going on.
  void Leave(const SourceFrame& frame) {
    constexpr std::size_t kMostShown = 3;
    ++in_a_row_;
    if (++result_.left_out == 1) {
      result_.first_problem = frame.problem;
    }
    if (in_a_row_ == 1) {
      row_problem_ = frame.problem;
      row_begins_ = frame.index;
    }
    const bool last = frame.index + 1 == frames_;
    if (!any_read_ && (last || in_a_row_ >= kGoneForGood)) {
      throw InputError(result_.first_problem);
    }
    if (in_a_row_ >= kGoneForGood || (last && in_a_row_ >= kGoneAtTheEnd)) {
      throw InputError(
          fmt::format("reading ended for good at frame {}: {} frames in a row cannot be read; the first: {}",
                      row_begins_, in_a_row_, row_problem_));
    }
    if (!any_read_) {
      return;
    }
    if (++shown_ <= kMostShown) {
      log::warn("frame {} is left out: {}", frame.index, frame.problem);
    } else if (shown_ == kMostShown + 1) {
      log::warn("frame {} is left out, too; more are counted, not shown", frame.index);
    }
  }
  [[nodiscard]] bool any_read() const { return any_read_; }

 private:
  std::size_t frames_;
  PlaybackResult& result_;
  std::size_t in_a_row_ = 0;
  std::size_t row_begins_ = 0;
  std::string row_problem_;
  bool any_read_ = false;
  std::size_t shown_ = 0;
};

}  // namespace

PlaybackResult Play(const Dataset& dataset, const PinholeCamera& camera, const Options& options,
                    std::unique_ptr<Segmenter> segmenter, const PlayOptions& play,
                    std::span<PlaybackObserver* const> observers) {
  cv::setNumThreads(1);  // times are those of one thread, and results do not depend on the machine
  PlaybackResult result;
  const Stopwatch wall;
  const double cpu_before_s = ProcessCpuSeconds();
  FrameSource source(dataset, camera);
  Slam slam(camera, options, std::move(segmenter));
  LeftOut left_out(dataset.size(), result);
  std::optional<std::string> strict_problem;
  std::optional<Schedule> schedule;
  const auto play_one = [&](const RgbdFrame& frame) {
    if (!schedule) {
      schedule.emplace(play.rate, dataset);
    }
    const double late_ms = schedule->Wait(frame.timestamp_s);
    if (Interrupted()) {
      return;
    }
    for (PlaybackObserver* observer : observers) {
      observer->BeforeFrame(frame);
    }
    FrameResult processed = slam.Process(frame);
    if (!result.first_pose_after_s && processed.world_from_camera) {
      result.first_pose_after_s = wall.Seconds();
    }
    const std::vector<SlamEvent> events = slam.TakeEvents();
    for (PlaybackObserver* observer : observers) {
      std::ranges::for_each(events, [&](const SlamEvent& event) { observer->OnEvent(event); });
      observer->AfterFrame(frame, processed, slam);
    }
    processed.features.clear();
    processed.features.shrink_to_fit();
    result.frames.push_back(std::move(processed));
    result.start_delay_ms.push_back(late_ms);
  };
  try {
    while (!Interrupted()) {
      const std::optional<SourceFrame> next = source.Next();
      if (!next) {
        break;
      }
      if (next->frame) {
        left_out.Read();
        play_one(*next->frame);
      } else if (play.strict) {
        strict_problem = next->problem;
        break;
      } else {
        left_out.Leave(*next);
      }
    }
  } catch (...) {
    if (!left_out.any_read()) {
      throw;
    }
    result.error = std::current_exception();
  }
  if (strict_problem) {
    throw InputError(*strict_problem);
  }
  result.interrupted = Interrupted();
  result.slam = slam.Finish();
  if (result.error == nullptr) {
    result.error = result.slam.error;
  }
  result.wall_s = wall.Seconds();
  result.cpu_s = ProcessCpuSeconds() - cpu_before_s;
  result.reading_cpu_s = source.CpuSeconds();
  return result;
}

}  // namespace rds
