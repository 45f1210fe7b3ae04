// SPDX-License-Identifier: Apache-2.0
#include "system/propagation_lane.h"

#include <span>

namespace rds {

void PropagationLane::Propagate(const TrackedFrame& frame) {
  const std::span<const DepthView> views =
      frame.views ? std::span<const DepthView>(*frame.views) : std::span<const DepthView>();
  newest_.Publish(propagator_.Next(frame.frame, *frame.data, frame.camera_from_world, views, frame.epoch));
}

std::shared_ptr<const PropagatedLabels> PropagationLane::Newest(FrameId frame) const {
  auto labels = newest_.Get();
  return labels && frame.value - labels->frame.value <= kOldest_frames ? labels : nullptr;
}

}  // namespace rds
