#include "system/label_follower.h"

#include <utility>

namespace rds {

LabelFollower::LabelFollower(const LabelCarryOptions& options, const FreeSpaceOptions& space, bool lockstep,
                             std::function<void(std::exception_ptr)> failed)
    : carrier_(options, space) {
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

LabelFollower::~LabelFollower() { frames_.Close(); }

void LabelFollower::Follow(const TrackedFrame& frame) {
  const std::span<const SeenView> views =
      frame.views ? std::span<const SeenView>(*frame.views) : std::span<const SeenView>();
  newest_.Publish(carrier_.Next(frame.frame, *frame.data, frame.camera_from_world, views));
}

void LabelFollower::Offer(TrackedFrame frame) {
  if (!worker_) {
    Follow(frame);
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
