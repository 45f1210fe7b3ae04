// SPDX-License-Identifier: Apache-2.0
// Frames of the last moments, to compare others with.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"

namespace rds {

// Keeps what there was to see in the last seconds. A value; not thread-safe by itself.
class RecentFrames {
 public:
  static constexpr double kWitness_s = 0.65;  // how far apart views should lie to be compared

  struct Entry {
    FrameId frame;
    double timestamp_s = 0;
    std::shared_ptr<const FrameData> data;
  };

  // Timestamps ascend.
  void Add(Entry entry);
  // Whether there are frames so much later than a timestamp that all witnesses of it are there.
  [[nodiscard]] bool ReachBeyond(double timestamp_s) const;
  // Frames to compare that of a timestamp with, the farthest first, about kWitness_s away and less: earlier ones, or
  // where they do not reach as far, later ones; those that are `preferred` rather than others.
  [[nodiscard]] std::vector<Entry> Witnesses(double timestamp_s, const std::function<bool(FrameId)>& preferred) const;

 private:
  std::deque<Entry> entries_;
};

}  // namespace rds
