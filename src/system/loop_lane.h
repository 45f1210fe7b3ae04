// SPDX-License-Identifier: Apache-2.0
// What is done about places that are seen again: without a thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "loop/loop_closer.h"
#include "runtime/guarded.h"
#include "runtime/published.h"
#include "system/backend.h"
#include "system/options.h"
#include "system/slam_event.h"
#include "tracking/tracker.h"

namespace rds {

// A frame that tracking could not place.
struct LostFrame {
  FrameId frame;
  double timestamp_s = 0;
  std::shared_ptr<const FrameData> data;
};

// Where it was taken.
struct PlacedFrame {
  KnownFrame frame;
  std::shared_ptr<const LocalMap> map;  // that holds the reference
  int matches = 0;
};

// What waits for the loop lane.
struct PlaceWork {
  std::optional<LostFrame> lost;     // the newest; before all else
  std::deque<KeyframeId> keyframes;  // that are new, or were labeled
  bool in_flight = false;            // one of these is worked at
  bool bundle_due = false;
  bool adjusting = false;
  bool closing = false;

  [[nodiscard]] bool HasWork() const { return lost.has_value() || !keyframes.empty(); }
  [[nodiscard]] bool IsIdle() const { return !HasWork() && !in_flight && !bundle_due && !adjusting; }
};

// Knows no thread. Place, Find and Learn have one caller at a time; so has Adjust, which may run beside them.
class LoopLane {
 public:
  LoopLane(const Options& options, bool semantics, Backend& backend);

  // Where in the map a frame was taken; null if that is not seen.
  [[nodiscard]] std::shared_ptr<const PlacedFrame> Place(const LostFrame& lost);
  // Looks for a lost frame in all of the map; NewestPlace tells.
  void Find(const LostFrame& lost);
  // Makes a keyframe known by its looks and, unless there are more of them than can be looked at (`only_index`), sees
  // whether its place was seen before. Whether the map was corrected, so that a full bundle adjustment is due.
  [[nodiscard]] bool Learn(KeyframeId keyframe, bool only_index);
  // Full bundle adjustment of the world that was corrected last; ended early by `stop` or by another correction.
  void Adjust(const std::function<bool()>& stop);

  [[nodiscard]] std::shared_ptr<const PlacedFrame> NewestPlace() const { return place_.Get(); }
  // The newest frame that tracking has begun, for the events' sake.
  void SetCurrentFrame(FrameId frame, double timestamp_s);
  void Record(SlamEvent event);
  // Those that were not taken yet, and all.
  [[nodiscard]] std::vector<SlamEvent> TakeEvents();
  [[nodiscard]] std::vector<SlamEvent> events() const;

 private:
  struct Log {
    FrameId frame;
    double timestamp_s = 0;
    std::vector<SlamEvent> events;
    std::size_t taken = 0;
  };

  LoopOptions options_;
  Backend& backend_;
  LoopCloser closer_;
  Published<PlacedFrame> place_;
  Guarded<Log> log_;
  std::atomic<std::uint32_t> corrections_ = 0;
  std::atomic<std::uint32_t> world_ = 0;  // that was corrected last
};

}  // namespace rds
