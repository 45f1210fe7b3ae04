// SPDX-License-Identifier: Apache-2.0
// Frames of the last moments, to compare others with.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "feature/frame_data.h"

namespace rds {

// Keeps what there was to see in the last seconds. A value; not thread-safe by itself.
class RecentFrames {
 public:
  static constexpr double kWitness_s = 0.65;  // how far apart views should lie to be compared

  // Timestamps ascend.
  void Add(double timestamp_s, std::shared_ptr<const FrameData> data);
  // Frames to compare that of a timestamp with, the farthest first, up to kWitness_s away: earlier ones, or where they
  // do not reach as far, later ones.
  [[nodiscard]] std::vector<std::shared_ptr<const FrameData>> Witnesses(double timestamp_s) const;

 private:
  struct Entry {
    double timestamp_s = 0;
    std::shared_ptr<const FrameData> data;
  };

  std::deque<Entry> entries_;
};

}  // namespace rds
