// SPDX-License-Identifier: Apache-2.0
// What happens to the depth image of a tracked frame: labels are propagated to it.
#pragma once

#include <memory>
#include <vector>

#include "propagation/label_propagation.h"
#include "runtime/published.h"

namespace rds {

// A tracked frame, and the labeled ones there were by then (may be null).
struct TrackedFrame {
  FrameId frame;
  std::shared_ptr<const FrameData> data;
  Rigid3 camera_from_world;
  std::shared_ptr<const std::vector<DepthView>> views;
  std::uint32_t epoch = 0;  // of the map that the pose and the views are in
};

// Knows no thread. Propagate has one caller at a time; Newest may be called from any thread and never waits.
class PropagationLane {
 public:
  PropagationLane(const PropagationOptions& options, const FreeSpaceOptions& space) : propagator_(options, space) {}

  // Frames ascend.
  void Propagate(const TrackedFrame& frame);
  // The newest labels there are, for a frame: as a rule those of the frame before. Null before the first, and where
  // they are too old: what moves is elsewhere by then.
  [[nodiscard]] std::shared_ptr<const PropagatedLabels> Newest(FrameId frame) const;

 private:
  static constexpr std::uint32_t kOldest_frames = 6;

  LabelPropagator propagator_;
  Published<PropagatedLabels> newest_;
};

}  // namespace rds
