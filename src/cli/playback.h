// Plays a sequence through the system: the loop that run, bench and ablate share.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "io/dataset.h"
#include "semantic/segmenter.h"
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
  virtual void AfterFrame(const RgbdFrame& /*frame*/, const FrameResult& /*result*/, const Slam& /*slam*/) {}
};

// What playing measured. Times in seconds unless the name says otherwise.
struct PlaybackResult {
  std::vector<FrameResult> frames;  // of every frame processed, in order; without features
  std::vector<double> lateness_ms;  // one for each frame: begun after it was due; 0 = in time
  SlamResult slam;
  std::optional<double> first_pose_after_s;  // after the start of playing; absent: no frame was tracked
  double wall_s = 0;                         // from the start of playing to the end of Slam::Finish
  double cpu_s = 0;                          // of the whole process in that time
  double reading_cpu_s = 0;                  // the part of it that read and decoded images
  bool interrupted = false;                  // stopped early by a signal; everything before is valid
};

// Plays all frames of `dataset` as recorded (`rate` 1), so many times as fast, or as fast as it goes (0). A frame that
// falls due while the one before is being processed follows at once; none is left out. Stops reading at the first
// signal (see cli/interrupt.h) and finishes what it has. Throws what reading throws.
[[nodiscard]] PlaybackResult Play(const Dataset& dataset, const PinholeCamera& camera, const Options& options,
                                  std::unique_ptr<Segmenter> segmenter, double rate,
                                  std::span<PlaybackObserver* const> observers);

}  // namespace rds
