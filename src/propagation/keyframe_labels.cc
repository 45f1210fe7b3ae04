// SPDX-License-Identifier: Apache-2.0
#include "propagation/keyframe_labels.h"

#include <memory>
#include <optional>
#include <utility>

namespace rds {
namespace {

struct Question {
  PosedFrame keyframe;
  std::vector<PosedFrame> earlier;
};

}  // namespace

void LabelKeyframe(MapAccess& map, FrameId frame, std::vector<KeypointLabel> labels, bool certain,
                   const FreeSpaceOptions& options) {
  if (options.enabled) {
    const auto question = map.Read([&](const Map& locked) -> std::optional<Question> {
      const Keyframe* const keyframe = locked.FindByFrame(frame);
      if (keyframe == nullptr) {
        return std::nullopt;
      }
      return Question{{frame, keyframe->data, keyframe->camera_from_world}, EarlierKeyframes(locked, keyframe->id)};
    });
    if (question) {
      std::vector<DepthView> views;
      for (const PosedFrame& earlier : question->earlier) {
        views.push_back(MakeView(earlier.frame, earlier.data, earlier.camera_from_world, {}));
      }
      const FrameData& data = *question->keyframe.data;
      MarkNewlyOccupied(data, CheckFreeSpace(data, question->keyframe.camera_from_world, views, options), labels);
    }
  }
  map.Write([&](Map& locked) {
    if (const Keyframe* const keyframe = locked.FindByFrame(frame)) {
      locked.Label(keyframe->id, std::move(labels), certain);
    } else {
      locked.KeepEarlyLabels(frame, std::move(labels));
    }
  });
}

}  // namespace rds
