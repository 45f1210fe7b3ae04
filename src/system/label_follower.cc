#include "system/label_follower.h"

#include <utility>

#include "base/error.h"

namespace rds {
namespace {

constexpr int kMoveEvery = 10;  // frames; the caller may have moved to another core since

}  // namespace

LabelFollower::LabelFollower(const FeatureTrackOptions& options, const MovingProbabilityOptions& probability,
                             const FreeSpaceOptions& space, MovingProbabilities& labels, bool lockstep)
    : tracks_(options), probability_(probability), space_(space), labels_(labels) {
  if (!lockstep) {
    worker_.emplace([this] { Run(); });
  }
}

LabelFollower::~LabelFollower() {
  frames_.Close();
  results_.Close();
}

void LabelFollower::Run() {
  try {
    while (auto frame = frames_.Pop()) {
      if (!results_.Push(Follow(std::move(*frame)))) {
        return;
      }
    }
  } catch (...) {
    results_.Close();  // so that Get learns of it
    throw;
  }
}

KeypointLabels LabelFollower::Follow(Request request) {
  std::vector<KeypointLabel> judged;
  if (space_.enabled && request.views && request.expected) {
    judged = JudgeBySpace(*request.frame, *request.expected, *request.views, space_);
  }
  return tracks_.Follow(std::move(request.frame), judged, labels_, probability_);
}

void LabelFollower::Begin(std::shared_ptr<const FrameData> frame, std::shared_ptr<const std::vector<SeenView>> views,
                          const std::optional<Rigid3>& expected) {
  if (worker_ && begun_++ % kMoveEvery == 0) {
    worker_->LeaveCallersCore();
  }
  Check(frames_.TryPush({std::move(frame), std::move(views), expected}), "Get follows Begin");
}

KeypointLabels LabelFollower::Get() {
  if (!worker_) {
    auto frame = frames_.Pop();
    Check(frame.has_value(), "Begin comes before Get");
    return Follow(std::move(*frame));
  }
  auto labels = results_.Pop();
  if (!labels) {
    worker_->Join();
  }
  Check(labels.has_value(), "the thread that follows labels lives");
  return std::move(*labels);
}

}  // namespace rds
