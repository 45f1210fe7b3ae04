// SPDX-License-Identifier: Apache-2.0
#include "system/loop_lane.h"

#include <utility>

namespace rds {

LoopLane::LoopLane(const Options& options, bool semantics, Backend& backend)
    : options_(options.loop),
      backend_(backend),
      closer_(options.loop, ScalePyramid(options.orb.levels, options.orb.scale_factor), options.pose, semantics) {}

std::shared_ptr<const PlacedFrame> LoopLane::Place(const LostFrame& lost) {
  auto found = closer_.Relocalize(backend_, {lost.data, {}}, lost.timestamp_s);
  if (!found) {
    return nullptr;
  }
  const auto matches = static_cast<int>(found->matches.size());
  KnownFrame known{lost.frame, lost.timestamp_s, lost.data, found->keyframe, found->camera_from_keyframe, {}};
  known.points.assign(lost.data->size(), PointId{});
  for (const auto& [keypoint, point] : found->matches) {
    known.points[keypoint] = point;
  }
  return std::make_shared<const PlacedFrame>(PlacedFrame{std::move(known), std::move(found->map), matches});
}

void LoopLane::Find(const LostFrame& lost) {
  if (auto place = Place(lost)) {
    place_.Publish(std::move(place));
  }
}

bool LoopLane::Learn(KeyframeId keyframe, bool only_index) {
  closer_.Index(backend_, keyframe);
  const auto closure = only_index ? std::nullopt : closer_.Close(backend_, keyframe);
  if (!closure) {
    return false;
  }
  if (closure->moved) {
    world_.store(closure->world.value, std::memory_order_relaxed);
    corrections_.fetch_add(1, std::memory_order_relaxed);
  }
  backend_.PublishLocalMap(backend_.Read([](const Map& map) { return map.newest(); }));
  backend_.PublishView();
  if (!closure->moved) {
    return false;
  }
  SlamEvent event;
  event.kind = closure->merged.valid() ? SlamEventKind::kWorldsMerged : SlamEventKind::kLoopClosed;
  event.world = closure->world;
  event.merged = closure->merged;
  event.into_from_from = closure->into_from_from;
  event.matches = closure->matches;
  Record(event);
  return closure->moved_far;
}

void LoopLane::Adjust(const std::function<bool()>& stop) {
  const std::uint32_t corrections = corrections_.load(std::memory_order_relaxed);
  const bool adjusted = closer_.Adjust(backend_, WorldId{world_.load(std::memory_order_relaxed)}, [&] {
    return (stop && stop()) || corrections_.load(std::memory_order_relaxed) != corrections;
  });
  if (adjusted) {
    backend_.PublishLocalMap(backend_.Read([](const Map& map) { return map.newest(); }));
    backend_.PublishView();
  }
}

void LoopLane::SetCurrentFrame(FrameId frame, double timestamp_s) {
  log_.Write([&](Log& log) {
    log.frame = frame;
    log.timestamp_s = timestamp_s;
  });
}

void LoopLane::Record(SlamEvent event) {
  log_.Write([&](Log& log) {
    event.frame = log.frame;
    event.timestamp_s = log.timestamp_s;
    log.events.push_back(event);
  });
}

std::vector<SlamEvent> LoopLane::TakeEvents() {
  return log_.Write([](Log& log) {
    const auto first = log.events.begin() + static_cast<std::ptrdiff_t>(std::exchange(log.taken, log.events.size()));
    return std::vector<SlamEvent>(first, log.events.end());
  });
}

std::vector<SlamEvent> LoopLane::events() const {
  return log_.Read([](const Log& log) { return log.events; });
}

}  // namespace rds
