// SPDX-License-Identifier: Apache-2.0
#include "cli/observers.h"

namespace rds {
void VideoObserver::AfterFrame(const RgbdFrame& frame, const FrameResult& result, const Slam& slam) {
  rate_.Tick(watch_.Seconds());
  if (!recorder_.Wants(result.frame)) {
    return;
  }
  RunViewContent content;
  content.image = frame.image;
  content.result = result;
  content.mask = slam.ViewMask();
  content.map = slam.ViewMap();
  content.frames_per_s = rate_.PerSecond();
  recorder_.Add(std::move(content));
}

}  // namespace rds
