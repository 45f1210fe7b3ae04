// SPDX-License-Identifier: Apache-2.0
// What looks on while a sequence is played: the progress display and the video.
#pragma once

#include <memory>
#include <string>

#include "base/time.h"
#include "cli/playback.h"
#include "cli/progress.h"
#include "io/video.h"

namespace rds {

// Feeds a Progress.
class ProgressObserver final : public PlaybackObserver {
 public:
  explicit ProgressObserver(Progress& progress) : progress_(progress) {}
  void AfterFrame(const RgbdFrame& /*frame*/, const FrameResult& result, const Slam& /*slam*/) override {
    progress_.Update(result, watch_.Seconds());
  }

 private:
  Progress& progress_;
  Stopwatch watch_;
};

// Feeds a VideoRecorder: hands the image and the view of the map over; draws nothing itself.
class VideoObserver final : public PlaybackObserver {
 public:
  explicit VideoObserver(VideoRecorder& recorder) : recorder_(recorder) {}
  void OnEvent(const SlamEvent& event) override;
  void AfterFrame(const RgbdFrame& frame, const FrameResult& result, const Slam& slam) override;

 private:
  VideoRecorder& recorder_;
  FrameRateMeter rate_;
  Stopwatch watch_;
  std::string note_;             // on the last event
  double note_ends_s_ = -1e300;  // by the recording's clock
};

}  // namespace rds
