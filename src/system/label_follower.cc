#include "system/label_follower.h"

#include <utility>

namespace rds {

LabelFollower::LabelFollower(const LabelCarryOptions& options, const FreeSpaceOptions& space, bool lockstep)
    : carrier_(options, space) {
  if (!lockstep) {
    worker_.emplace([this] {
      while (const auto frame = frames_.Pop()) {
        Follow(*frame);
      }
    });
  }
}

LabelFollower::~LabelFollower() { frames_.Close(); }

void LabelFollower::Follow(const TrackedFrame& frame) {
  const std::span<const SeenView> views =
      frame.views ? std::span<const SeenView>(*frame.views) : std::span<const SeenView>();
  newest_.Publish(carrier_.Next(frame.frame, *frame.data, frame.camera_from_world, views));
}

void LabelFollower::Offer(TrackedFrame frame) {
  if (!worker_) {
    Follow(frame);
  } else if (worker_->WaitFor(0)) {
    worker_->Join();  // it ended by an error
  } else {
    worker_->StayOffCallersCore();
    static_cast<void>(frames_.TryPush(std::move(frame)));
  }
}

std::shared_ptr<const LabelField> LabelFollower::Newest(FrameId frame) const {
  auto labels = newest_.Get();
  return labels && frame.value - labels->frame.value <= kOldest_frames ? labels : nullptr;
}

}  // namespace rds
