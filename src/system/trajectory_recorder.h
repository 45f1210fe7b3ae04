// SPDX-License-Identifier: Apache-2.0
// The poses of all tracked frames, as they hang on their keyframes.
#pragma once

#include <optional>
#include <vector>

#include "geometry/trajectory.h"
#include "map/map.h"
#include "tracking/tracker.h"

namespace rds {

// A piece of map with an origin of its own, and what was tracked in it.
struct WorldTrajectory {
  WorldId world;
  Trajectory frames;     // one pose for each tracked frame, with all later corrections of its reference keyframe
  Trajectory keyframes;  // keyframes that are in the map at the end
};

// Remembers each pose relative to its reference keyframe, so that whatever corrects the keyframe later corrects the
// frame. Where a frame became a keyframe itself, that one's pose is its own; by what this differs, the frames before it
// that hang on the same reference are corrected in proportion to the time. A value; one caller.
class TrajectoryRecorder {
 public:
  void Add(FrameId frame, double timestamp_s, const TrackOutcome& outcome);
  // A frame that was lost when it was added, and where it was found since; nothing before the first with a pose.
  void AddFound(FrameId frame, double timestamp_s, KeyframeId reference, const Rigid3& camera_from_reference);
  // The keyframe that the frame just added became, of a frame that started a world: its pose hangs on itself.
  void HangLastOn(KeyframeId keyframe) { entries_.back().reference = keyframe; }
  // Forgets the poses of a frame and of those after it. So many of the last frames are to come again, the others count
  // as lost.
  void GiveUp(FrameId first, std::size_t last_frames);

  [[nodiscard]] bool Has(FrameId frame) const;
  [[nodiscard]] bool HasAfter(FrameId frame) const { return !entries_.empty() && entries_.back().frame > frame; }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  // Frames since the first tracked one that have no pose.
  [[nodiscard]] int lost() const { return lost_; }
  // Of those with a pose, those that were found.
  [[nodiscard]] int found() const { return found_; }
  // World poses as the map has them now, for each world that has any; ascending in time. The world with most frames
  // comes first, the older of equals.
  [[nodiscard]] std::vector<WorldTrajectory> Resolve(const Map& map) const;

 private:
  struct Entry {
    FrameId frame;
    double timestamp_s = 0;
    KeyframeId reference;
    Rigid3 camera_from_reference;
    bool found = false;
  };

  std::vector<Entry> entries_;
  int lost_ = 0;
  int found_ = 0;
};

}  // namespace rds
