// SPDX-License-Identifier: Apache-2.0
#include "system/trajectory_recorder.h"

#include <algorithm>
#include <map>

namespace rds {

void TrajectoryRecorder::Add(FrameId frame, double timestamp_s, const TrackOutcome& outcome) {
  if (outcome.tracked) {
    entries_.push_back({frame, timestamp_s, outcome.reference, outcome.camera_from_reference, false});
  } else if (!entries_.empty()) {
    ++lost_;
  }
}

void TrajectoryRecorder::AddFound(FrameId frame, double timestamp_s, KeyframeId reference,
                                  const Rigid3& camera_from_reference) {
  if (entries_.empty() || frame < entries_.front().frame) {
    return;
  }
  entries_.insert(std::ranges::lower_bound(entries_, frame, {}, &Entry::frame),
                  {frame, timestamp_s, reference, camera_from_reference, true});
  --lost_;
  ++found_;
}

bool TrajectoryRecorder::Has(FrameId frame) const {
  return std::ranges::binary_search(entries_, frame, {}, &Entry::frame);
}

void TrajectoryRecorder::GiveUp(FrameId first, std::size_t last_frames) {
  const auto from = std::ranges::lower_bound(entries_, first, {}, &Entry::frame);
  lost_ += static_cast<int>(entries_.end() - from) - static_cast<int>(last_frames);
  entries_.erase(from, entries_.end());
}

std::vector<WorldTrajectory> TrajectoryRecorder::Resolve(const Map& map) const {
  // By reference: what the next keyframe that hangs on it has been corrected by since.
  struct Drift {
    double start_s = 0;
    double end_s = 0;
    Rigid3 world_from_old_world;
  };
  std::map<KeyframeId, Drift> drifts;
  const auto raw = [&](const Entry& entry) {
    return (entry.camera_from_reference * map.CameraFromWorld(entry.reference)).Inverse();
  };
  for (const Entry& entry : entries_) {
    const Keyframe* const self = map.FindByFrame(entry.frame);
    const Keyframe* const reference = map.Find(entry.reference);
    if (self != nullptr && reference != nullptr && self != reference && self->world == reference->world) {
      drifts.try_emplace(entry.reference, Drift{reference->timestamp_s, self->timestamp_s,
                                                self->camera_from_world.Inverse() * raw(entry).Inverse()});
    }
  }
  std::map<WorldId, Trajectory> trajectories;
  for (const Entry& entry : entries_) {
    if (!entry.reference.valid()) {  // the run ended before the frame became a keyframe
      continue;
    }
    Rigid3 world_from_camera = raw(entry);
    // What was found hangs on what it looks like, whenever that was.
    if (const auto drift = drifts.find(entry.reference); !entry.found && drift != drifts.end()) {
      const auto& [start_s, end_s, correction] = drift->second;
      const double share = std::clamp((entry.timestamp_s - start_s) / (end_s - start_s), 0.0, 1.0);
      // About the camera, not the origin of the world.
      const Eigen::Vector3d shift = correction * world_from_camera.translation - world_from_camera.translation;
      world_from_camera.translation += share * shift;
      world_from_camera.rotation =
          Eigen::Quaterniond::Identity().slerp(share, correction.rotation) * world_from_camera.rotation;
    }
    trajectories[map.WorldOf(entry.reference)].push_back({entry.timestamp_s, world_from_camera});
  }
  std::vector<WorldTrajectory> worlds;
  for (auto& [world, frames] : trajectories) {
    worlds.push_back({world, std::move(frames), {}});
  }
  std::ranges::stable_sort(worlds, std::ranges::greater(), [](const auto& world) { return world.frames.size(); });
  return worlds;
}

}  // namespace rds
