// SPDX-License-Identifier: Apache-2.0
// The public API: frames in, trajectory and map out.
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "geometry/trajectory.h"
#include "segmentation/segmenter.h"
#include "system/frame.h"
#include "system/options.h"

namespace rds {

// What the semantic threads did with one keyframe.
struct LabelEvent {
  FrameId labeled_frame;       // frame of the keyframe that was labeled
  FrameId current_frame;       // newest frame when its label arrived
  double segmentation_ms = 0;  // of the request (shared by the keyframes of a batch)
  double mask_ms = 0;          // dilation
  double update_ms = 0;        // Bayes step
  double optimization_ms = 0;  // semantic-based optimization; 0 = none was due
};

// A view for drawing: the map as of its newest change. Immutable once handed out.
struct MapView {
  std::vector<Rigid3> keyframes;          // world_from_camera, in order of creation
  std::vector<Eigen::Vector3f> points;    // in the world frame, meters
  std::vector<float> moving_probability;  // one for each point
};

// Mask of the newest labeled keyframe, dilated: 255 = dynamic. For drawing.
struct MaskView {
  FrameId frame;
  std::shared_ptr<const Image8> mask;  // null before the first label
};

// Outcome of a run.
struct SlamResult {
  Trajectory frames;     // one pose for each tracked frame, with all later corrections of its reference keyframe
  Trajectory keyframes;  // keyframes that are in the map at the end
  int processed_frames = 0;
  int tracked_frames = 0;
  int lost_frames = 0;
  std::vector<double> local_ba_ms;  // one for each local bundle adjustment
  std::vector<LabelEvent> labels;   // in order of arrival
  int segmentation_failures = 0;    // keyframes whose request threw or gave no usable mask
  int keyframes_left_unlabeled = 0;
  MapView map;
  int static_points = 0;
  int unknown_points = 0;
  int dynamic_points = 0;
  std::exception_ptr error;  // that ended the run early; null if none. All above is what there was until then
};

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

  // For drawing; may be called between Process calls, and takes no lock of the map. ViewMap is never null, and empty
  // unless options.system.keep_features.
  [[nodiscard]] std::shared_ptr<const MapView> ViewMap() const;
  [[nodiscard]] MaskView ViewMask() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
