// SPDX-License-Identifier: Apache-2.0
// Plays a sequence through the system: the loop that run, bench and ablate share.
#pragma once

#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "io/dataset.h"
#include "segmentation/segmenter.h"
#include "system/frame.h"
#include "system/options.h"
#include "system/slam.h"

namespace rds {

// Looks on while frames are played, on the thread that plays. Its time is not tracking's, but late is late: keep it
// short at real time.
class PlaybackObserver {
 public:
  virtual ~PlaybackObserver() = default;
  virtual void BeforeFrame(const RgbdFrame& /*frame*/) {}
  // What happened to the map as a whole since the frame before; before AfterFrame.
  virtual void OnEvent(const SlamEvent& /*event*/) {}
  virtual void AfterFrame(const RgbdFrame& /*frame*/, const FrameResult& /*result*/, const Slam& /*slam*/) {}
};

// What playing measured. Times in seconds unless the name says otherwise.
struct PlaybackResult {
  std::vector<FrameResult> frames;     // of every frame processed, in order; without features
  std::vector<double> start_delay_ms;  // one for each frame: begun after it was due; 0 = in time
  SlamResult slam;
  std::optional<double> first_pose_after_s;  // after the start of playing; absent: no frame was tracked
  double wall_s = 0;                         // from the start of playing to the end of Slam::Finish
  double cpu_s = 0;                          // of the whole process in that time
  double reading_cpu_s = 0;                  // the part of it that read and decoded images
  bool interrupted = false;                  // stopped early by a signal; everything before is valid
  std::size_t left_out = 0;                  // frames whose files cannot be read
  std::string first_problem{};               // of those
  std::exception_ptr error;                  // that ended the run early; everything before is valid
};

struct PlayOptions {
  double rate = 1;      // as recorded, so many times as fast, or as fast as it goes (0)
  bool strict = false;  // a frame whose files cannot be read is an error; else it is left out, with a warning
};

// Plays all frames of `dataset`. A frame that falls due while the one before is being processed follows at once; none
// is left out for want of time. Pauses of the recording are cut to a second. Stops reading at the first signal (see
// cli/interrupt.h) or error and finishes what it has: the error is part of the result. That many unreadable frames in a
// row, or to the end, are such an error (kGoneForGood). Throws InputError if no frame can be read at all.
[[nodiscard]] PlaybackResult Play(const Dataset& dataset, const PinholeCamera& camera, const Options& options,
                                  std::unique_ptr<Segmenter> segmenter, const PlayOptions& play,
                                  std::span<PlaybackObserver* const> observers);

// Throws the error that ended the run early, if one did.
inline void RethrowError(const PlaybackResult& playback) {
  if (playback.error != nullptr) {
    std::rethrow_exception(playback.error);
  }
}

inline constexpr std::size_t kGoneForGood = 30;
inline constexpr std::size_t kGoneAtTheEnd = 5;

}  // namespace rds
