// SPDX-License-Identifier: Apache-2.0
#include "system/propagation_lane.h"

#include <utility>

namespace rds {

PropagationLane::PropagationLane(const PropagationOptions& options, const FreeSpaceOptions& space, bool lockstep,
                                 std::function<void(std::exception_ptr)> failed)
    : propagator_(options, space) {
  if (!lockstep) {
    worker_.emplace([this, failed = std::move(failed)] {
      try {
        while (const auto frame = frames_.Pop()) {
          Follow(*frame);
        }
      } catch (...) {
        frames_.Close();
        failed(std::current_exception());
      }
    });
  }
}

PropagationLane::~PropagationLane() { frames_.Close(); }

void PropagationLane::Follow(const TrackedFrame& frame) {
  const std::span<const DepthView> views =
      frame.views ? std::span<const DepthView>(*frame.views) : std::span<const DepthView>();
  newest_.Publish(propagator_.Next(frame.frame, *frame.data, frame.camera_from_world, views));
}

void PropagationLane::Offer(TrackedFrame frame) {
  if (!worker_) {
    Follow(frame);
  } else {
    worker_->StayOffCallersCore();
    static_cast<void>(frames_.TryPush(std::move(frame)));
  }
}

std::shared_ptr<const PropagatedLabels> PropagationLane::Newest(FrameId frame) const {
  auto labels = newest_.Get();
  return labels && frame.value - labels->frame.value <= kOldest_frames ? labels : nullptr;
}

}  // namespace rds
