// SPDX-License-Identifier: Apache-2.0
#include "system/trajectory_recorder.h"

namespace rds {

void TrajectoryRecorder::Add(double timestamp_s, const TrackOutcome& outcome) {
  if (outcome.tracked) {
    entries_.push_back({timestamp_s, outcome.reference, outcome.camera_from_reference});
  } else if (!entries_.empty()) {
    ++lost_;
  }
}

void TrajectoryRecorder::GiveUp(std::size_t last_frames) {
  lost_ += static_cast<int>(entries_.size()) - static_cast<int>(last_frames);
  entries_.clear();
}

Trajectory TrajectoryRecorder::Resolve(const Map& map) const {
  Trajectory trajectory;
  for (const Entry& entry : entries_) {
    if (entry.reference.valid()) {  // else the run ended before the frame became a keyframe
      const Rigid3 camera_from_world = entry.camera_from_reference * map.CameraFromWorld(entry.reference);
      trajectory.push_back({entry.timestamp_s, camera_from_world.Inverse()});
    }
  }
  return trajectory;
}

}  // namespace rds
