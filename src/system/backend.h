// SPDX-License-Identifier: Apache-2.0
// The map behind its lock, and what is published of it.
#pragma once

#include <memory>
#include <optional>

#include "map/local_map.h"
#include "map/map_access.h"
#include "runtime/guarded.h"
#include "runtime/lock_times.h"
#include "runtime/published.h"
#include "system/slam_result.h"

namespace rds {

// Any thread may call anything. Tracking takes snapshots and the table of moving probabilities, and never the lock.
class Backend final : public MapAccess {
 public:
  // `views`: whoever draws wants a MapView with each change.
  Backend(const ScalePyramid& pyramid, const MovingProbabilityOptions& probability, const LocalMapOptions& local_map,
          bool views);

  [[nodiscard]] const MovingProbabilities& probabilities() const { return *probabilities_; }  // takes no lock

  // Publishes the surroundings of a keyframe for tracking.
  void PublishLocalMap(KeyframeId around);
  // Publishes a snapshot, unless many poses have changed since it was made.
  void Publish(std::shared_ptr<const LocalMap> map);
  // Publishes the whole map for drawing, if that is wanted.
  void PublishView();
  // The newest ones. No lock but that of the mailbox. Null before the first local map; a view is never null.
  [[nodiscard]] std::shared_ptr<const LocalMap> CurrentLocalMap() const { return local_map_.Get(); }
  [[nodiscard]] std::shared_ptr<const MapView> CurrentView() const;

  // Of one world, or of all.
  [[nodiscard]] MapView MakeView(std::optional<WorldId> world = std::nullopt) const;
  [[nodiscard]] LockTimes lock_times() const;

 protected:
  void DoRead(const std::function<void(const Map&)>& function) const override;
  void DoWrite(const std::function<void(Map&)>& function) override;

 private:
  struct State {
    State(const ScalePyramid& pyramid, const MovingProbabilityOptions& probability) : map(pyramid, probability) {}
    Map map;
    mutable LockTimes times;
  };

  LocalMapOptions local_map_options_;
  bool views_;
  Guarded<State> state_;
  const MovingProbabilities* probabilities_;  // of the map; wait-free
  Published<LocalMap> local_map_;
  Published<MapView> view_;
};

}  // namespace rds
