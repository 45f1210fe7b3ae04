// SPDX-License-Identifier: Apache-2.0
#include "system/backend.h"

#include "base/time.h"

namespace rds {
namespace {

// Runs a function on the state, whose lock is held by now, and adds up the times.
template <typename State, typename Function>
void Timed(const Stopwatch& since_asked, State& state, const Function& function) {
  const double waited_ms = since_asked.Milliseconds();
  function(state.map);
  state.times.Add(waited_ms, since_asked.Milliseconds() - waited_ms);
}

}  // namespace

Backend::Backend(const ScalePyramid& pyramid, const MovingProbabilityOptions& probability,
                 const LocalMapOptions& local_map, bool views)
    : local_map_options_(local_map),
      views_(views),
      state_(pyramid, probability),
      probabilities_(state_.Read([](const State& state) { return &state.map.probabilities(); })) {}

void Backend::DoRead(const std::function<void(const Map&)>& function) const {
  const Stopwatch watch;
  state_.Read([&](const State& state) { Timed(watch, state, function); });
}

void Backend::DoWrite(const std::function<void(Map&)>& function) {
  const Stopwatch watch;
  state_.Write([&](State& state) { Timed(watch, state, function); });
}

LockTimes Backend::lock_times() const {
  return state_.Read([](const State& state) { return state.times; });
}

void Backend::PublishLocalMap(KeyframeId around) {
  Publish(Read([&](const Map& map) { return BuildLocalMap(map, around, local_map_options_); }));
}

void Backend::Publish(std::shared_ptr<const LocalMap> map) {
  local_map_.PublishUnless(std::move(map),
                           [](const LocalMap& one, const LocalMap& present) { return one.epoch < present.epoch; });
}

void Backend::PublishView() {
  if (views_) {
    // Worlds have nothing to do with each other: one is shown, that of the newest keyframe.
    const auto world = Read(
        [](const Map& map) { return map.newest().valid() ? std::optional(map.At(map.newest()).world) : std::nullopt; });
    view_.Publish(std::make_shared<const MapView>(MakeView(world)));
  }
}

std::shared_ptr<const MapView> Backend::CurrentView() const {
  auto view = view_.Get();
  return view ? view : std::make_shared<const MapView>();
}

MapView Backend::MakeView(std::optional<WorldId> world) const {
  return Read([&](const Map& map) {
    MapView view;
    for (const KeyframeId id : map.keyframes()) {
      if (world && map.At(id).world != *world) {
        continue;
      }
      view.keyframes.push_back(map.At(id).camera_from_world.Inverse());
    }
    for (const PointId id : map.Points()) {
      if (world && map.At(map.At(id).reference).world != *world) {
        continue;
      }
      view.points.push_back(map.At(id).position.cast<float>());
      view.moving_probability.push_back(static_cast<float>(map.probabilities().Get(id)));
    }
    return view;
  });
}

}  // namespace rds
