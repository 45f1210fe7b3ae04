// SPDX-License-Identifier: Apache-2.0
// What a run gives, and what may be looked at while it lasts.
#pragma once

#include <Eigen/Core>
#include <exception>
#include <memory>
#include <vector>

#include "base/ids.h"
#include "base/image.h"
#include "geometry/rigid3.h"
#include "geometry/trajectory.h"
#include "system/slam_event.h"
#include "system/trajectory_recorder.h"

namespace rds {

// What the semantic thread did with one keyframe.
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

// How long threads held the lock of the map and waited for it, milliseconds.
struct LockSummary {
  struct Series {
    double median = 0;
    double p95 = 0;
    double max = 0;
  };
  Series held;
  Series waited;
  double max_waited_by_tracking = 0;
};

// Outcome of a run.
struct SlamResult {
  Trajectory frames;  // as in the largest world
  Trajectory keyframes;
  std::vector<WorldTrajectory> worlds;  // those with tracked frames, most frames first; the first one is that above
  std::vector<SlamEvent> events;        // in order
  int processed_frames = 0;
  int tracked_frames = 0;
  int lost_frames = 0;
  int found_frames = 0;             // of the tracked ones: lost when they came, found in the map at the end
  std::vector<double> local_ba_ms;  // one for each local bundle adjustment
  std::vector<LabelEvent> labels;   // in order of arrival
  int segmentation_failures = 0;    // keyframes whose request threw or gave no usable mask
  int keyframes_left_unlabeled = 0;
  LockSummary map_lock_ms;
  MapView map;
  int static_points = 0;
  int unknown_points = 0;
  int dynamic_points = 0;
  std::exception_ptr error;  // that ended the run early; null if none. All above is what there was until then
};

}  // namespace rds
