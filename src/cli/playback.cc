#include "cli/playback.h"

#include <algorithm>
#include <chrono>
#include <opencv2/core.hpp>
#include <thread>
#include <utility>

#include "base/time.h"
#include "cli/frame_source.h"
#include "cli/interrupt.h"

namespace rds {
namespace {

// When frames are due: the first when the clock starts, the others as much later as they were recorded.
class Schedule {
 public:
  Schedule(double rate, double first_timestamp_s) : rate_(rate), first_timestamp_s_(first_timestamp_s) {}

  // Waits until a frame is due; returns how late it is, in milliseconds. Returns early when interrupted.
  double Wait(double timestamp_s) const {
    if (rate_ == 0) {
      return 0;
    }
    const double due_s = (timestamp_s - first_timestamp_s_) / rate_;
    double late_s = watch_.Seconds() - due_s;
    while (late_s < 0 && !Interrupted()) {
      // In short pieces: a signal does not end a sleep.
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(-late_s, 0.05)));
      late_s = watch_.Seconds() - due_s;
      if (late_s >= 0) {
        return 0;
      }
    }
    return std::max(0.0, 1e3 * late_s);
  }

 private:
  double rate_;
  double first_timestamp_s_;
  Stopwatch watch_;
};

}  // namespace

PlaybackResult Play(const Dataset& dataset, const PinholeCamera& camera, const Options& options,
                    std::unique_ptr<Segmenter> segmenter, double rate, std::span<PlaybackObserver* const> observers) {
  cv::setNumThreads(1);  // times are those of one thread, and results do not depend on the machine
  PlaybackResult result;
  const Stopwatch wall;
  const double cpu_before_s = ProcessCpuSeconds();
  FrameSource source(dataset, camera);
  Slam slam(camera, options, std::move(segmenter));
  std::optional<Schedule> schedule;
  while (!Interrupted()) {
    const std::optional<RgbdFrame> frame = source.Next();
    if (!frame) {
      break;
    }
    if (!schedule) {
      schedule.emplace(rate, frame->timestamp_s);
    }
    const double late_ms = schedule->Wait(frame->timestamp_s);
    if (Interrupted()) {
      break;
    }
    for (PlaybackObserver* observer : observers) {
      observer->BeforeFrame(*frame);
    }
    FrameResult processed = slam.Process(*frame);
    if (!result.first_pose_after_s && processed.world_from_camera) {
      result.first_pose_after_s = wall.Seconds();
    }
    for (PlaybackObserver* observer : observers) {
      observer->AfterFrame(*frame, processed, slam);
    }
    processed.features.clear();
    processed.features.shrink_to_fit();
    result.frames.push_back(std::move(processed));
    result.lateness_ms.push_back(late_ms);
  }
  result.interrupted = Interrupted();
  result.slam = slam.Finish();
  result.wall_s = wall.Seconds();
  result.cpu_s = ProcessCpuSeconds() - cpu_before_s;
  result.reading_cpu_s = source.CpuSeconds();
  return result;
}

}  // namespace rds
