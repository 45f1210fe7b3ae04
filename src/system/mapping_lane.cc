// SPDX-License-Identifier: Apache-2.0
#include "system/mapping_lane.h"

#include <utility>

#include "base/time.h"
#include "propagation/keyframe_labels.h"

namespace rds {

MappingLane::MappingLane(const Options& options, bool semantics, Backend& backend)
    : free_space_(options.semantic.free_space), semantics_(semantics), backend_(backend), mapper_(options.mapping) {}

KeyframeId MappingLane::Map(const KeyframeCandidate& candidate, const std::function<bool()>& should_stop) {
  std::vector<KeypointLabel> early;
  const KeyframeId id = backend_.Write([&](rds::Map& map) {
    early = map.TakeEarlyLabels(candidate.frame);
    return mapper_.Insert(map, candidate);
  });
  if (!early.empty()) {
    LabelKeyframe(backend_, candidate.frame, std::move(early), false, free_space_);
  }
  backend_.PublishLocalMap(id);
  mapper_.Refine(backend_, id);
  if (!should_stop()) {
    const Stopwatch watch;
    if (mapper_.Adjust(backend_, id, semantics_, should_stop)) {
      local_ba_ms_.Write([&](auto& times) { times.push_back(watch.Milliseconds()); });
    }
  }
  mapper_.CullKeyframes(backend_, id);  // however much waits: or the map of one room grows for ever
  backend_.PublishLocalMap(id);
  backend_.PublishView();
  return id;
}

std::vector<double> MappingLane::local_ba_ms() const {
  return local_ba_ms_.Read([](const auto& times) { return times; });
}

}  // namespace rds
