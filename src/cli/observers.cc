#include "cli/observers.h"

namespace rds {
namespace {

// A copy of the map serves so many pictures.
constexpr int kFramesPerMapCopy = 10;

}  // namespace

void VideoObserver::AfterFrame(const RgbdFrame& frame, const FrameResult& result, const Slam& slam) {
  rate_.Tick(watch_.Seconds());
  if (!recorder_.Wants(result.frame)) {
    return;
  }
  if (map_ == nullptr || ++frames_since_map_ >= kFramesPerMapCopy) {
    map_ = std::make_shared<const MapView>(slam.ViewMap());
    frames_since_map_ = 0;
  }
  RunViewContent content;
  content.image = frame.image;
  content.result = result;
  content.mask = slam.ViewMask();
  content.map = map_;
  content.frames_per_s = rate_.PerSecond();
  recorder_.Add(std::move(content));
}

}  // namespace rds
