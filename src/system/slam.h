// SPDX-License-Identifier: Apache-2.0
// The public API: frames in, trajectory and map out.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "segmentation/segmenter.h"
#include "system/frame.h"
#include "system/options.h"
#include "system/slam_result.h"

namespace rds {

// RGB-D SLAM. One caller's thread calls Process and Finish; worker threads live inside and are joined by Finish or the
// destructor. World frame: the camera frame of the first tracked frame. Throws InputError for images of a wrong size
// or type and for timestamps that do not increase; the system stays usable after that. Any other exception, of this
// thread or of a worker, ends the run: Process throws it, now and from then on, and Finish still gives what there is.
class Slam {
 public:
  // `segmenter` may be null (no semantics). In lockstep (options.system.lockstep) everything runs on the caller's
  // thread in a fixed order. Throws InputError for options out of range, a camera whose distortion cannot be undone,
  // and where the system gives no thread.
  Slam(const PinholeCamera& camera, const Options& options, std::unique_ptr<Segmenter> segmenter = nullptr);
  ~Slam();
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  // Tracks one frame. Never waits for mapping or segmentation (threaded executor).
  FrameResult Process(const RgbdFrame& frame);

  // Lets the workers finish what is queued (labels still missing are waited for up to a limit), joins them and returns
  // the result. No Process after that. Does not throw what a worker threw: see SlamResult::error.
  SlamResult Finish();

  // What happened to the map as a whole since the last call: worlds that began, loops, merges, relocalizations. All of
  // it is in SlamResult::events again. From any thread.
  [[nodiscard]] std::vector<SlamEvent> TakeEvents();

  // For drawing; may be called between Process calls, and takes no lock of the map. ViewMap is never null, and empty
  // unless options.system.keep_features.
  [[nodiscard]] std::shared_ptr<const MapView> ViewMap() const;
  [[nodiscard]] MaskView ViewMask() const;

  // What is wrong with the map, in words; empty if all of its invariants hold. Walks over all of it; for tests.
  [[nodiscard]] std::vector<std::string> ValidateMap() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
