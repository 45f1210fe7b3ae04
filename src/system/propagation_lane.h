// SPDX-License-Identifier: Apache-2.0
// The thread that carries labels from frame to frame, beside tracking.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "propagation/label_propagation.h"
#include "runtime/bounded_queue.h"
#include "runtime/published.h"
#include "runtime/worker.h"

namespace rds {

// Runs LabelPropagator on a thread of its own; tracking never waits for it, and takes the newest labels there are: as a
// rule those of the frame before. In lockstep it works when it is offered a frame. One caller.
class PropagationLane {
 public:
  struct TrackedFrame {
    FrameId frame;
    std::shared_ptr<const FrameData> data;
    Rigid3 camera_from_world;
    std::shared_ptr<const std::vector<DepthView>> views;  // labeled ones; may be null
  };

  // `failed` is told, on the thread, of an error that ends it.
  PropagationLane(const PropagationOptions& options, const FreeSpaceOptions& space, bool lockstep,
                  std::function<void(std::exception_ptr)> failed);
  ~PropagationLane();

  // Frames ascend. Never waits: where the thread is far behind, or has failed, the frame is left out.
  void Offer(TrackedFrame frame);
  // For a frame. Null before the first, and where they are too old: what moves is elsewhere by then.
  [[nodiscard]] std::shared_ptr<const PropagatedLabels> Newest(FrameId frame) const;

 private:
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::uint32_t kOldest_frames = 6;

  void Follow(const TrackedFrame& frame);

  LabelPropagator propagator_;
  BoundedQueue<TrackedFrame> frames_{kMostWaiting};
  Published<PropagatedLabels> newest_;
  std::optional<Worker> worker_;  // none in lockstep
};

}  // namespace rds
