// SPDX-License-Identifier: Apache-2.0
#include "cli/observers.h"

#include <spdlog/fmt/fmt.h>

namespace rds {
void VideoObserver::OnEvent(const SlamEvent& event) {
  constexpr double kShown_s = 2;
  switch (event.kind) {
    case SlamEventKind::kWorldStarted:
      note_ = event.frame.value == 0 ? "" : fmt::format("lost: another world ({}) begins", event.world.value);
      break;
    case SlamEventKind::kRelocalized:
      note_ = fmt::format("found again in world {}", event.world.value);
      break;
    case SlamEventKind::kLoopClosed:
      note_ = "loop closed";
      break;
    case SlamEventKind::kWorldsMerged:
      note_ = fmt::format("worlds {} and {} are one", event.world.value, event.merged.value);
      break;
  }
  note_ends_s_ = event.timestamp_s + kShown_s;
}

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
  content.note = frame.timestamp_s < note_ends_s_ ? note_ : "";
  recorder_.Add(std::move(content));
}

}  // namespace rds
