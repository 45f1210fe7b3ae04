// SPDX-License-Identifier: Apache-2.0
// What must always be true of a map.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "map/map.h"

namespace rds {
namespace {

// Collects complaints. Each check says what should be true and of what.
class Complaints {
 public:
  template <typename... Arguments>
  bool Expect(bool holds, fmt::format_string<Arguments...> otherwise, Arguments&&... arguments) {
    if (!holds) {
      list_.push_back(fmt::format(otherwise, std::forward<Arguments>(arguments)...));
    }
    return holds;
  }
  [[nodiscard]] std::vector<std::string> Take() { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

void CheckLinks(const Map& map, const Keyframe& keyframe, Complaints& complaints) {
  complaints.Expect(keyframe.points.size() == keyframe.data->size(), "keyframe {} has {} links for {} keypoints",
                    keyframe.id.value, keyframe.points.size(), keyframe.data->size());
  complaints.Expect(!keyframe.IsLabeled() || keyframe.labels.size() == keyframe.points.size(),
                    "keyframe {} has {} labels for {} keypoints", keyframe.id.value, keyframe.labels.size(),
                    keyframe.points.size());
  for (std::uint32_t i = 0; i < keyframe.points.size(); ++i) {
    const PointId id = keyframe.points[i];
    const MapPoint* const point = id.valid() ? map.Find(id) : nullptr;
    if (id.valid() && complaints.Expect(point != nullptr, "keyframe {} sees point {}, which is not in the map",
                                        keyframe.id.value, id.value)) {
      const bool knows = std::ranges::any_of(point->observations, [&](const Observation& observation) {
        return observation.keyframe == keyframe.id && observation.keypoint == i;
      });
      complaints.Expect(knows, "point {} does not know that keypoint {} of keyframe {} shows it", id.value, i,
                        keyframe.id.value);
    }
  }
}

void CheckEdges(const Map& map, const Keyframe& keyframe, Complaints& complaints) {
  const auto in_order = [](const Covisible& a, const Covisible& b) {
    return a.shared_points != b.shared_points ? a.shared_points > b.shared_points : a.keyframe < b.keyframe;
  };
  complaints.Expect(std::ranges::is_sorted(keyframe.covisible, in_order), "edges of keyframe {} are out of order",
                    keyframe.id.value);
  for (const Covisible& edge : keyframe.covisible) {
    const Keyframe* const other = map.Find(edge.keyframe);
    if (!complaints.Expect(other != nullptr && edge.keyframe != keyframe.id, "an edge of keyframe {} leads to {}",
                           keyframe.id.value, edge.keyframe.value)) {
      continue;
    }
    complaints.Expect(edge.shared_points > 0, "the edge from keyframe {} to {} has no points", keyframe.id.value,
                      other->id.value);
    const auto back = std::ranges::count_if(other->covisible, [&](const Covisible& c) {
      return c.keyframe == keyframe.id && c.shared_points == edge.shared_points;
    });
    complaints.Expect(back == 1, "the edge from keyframe {} to {} is there {} times in the other direction",
                      keyframe.id.value, other->id.value, back);
    complaints.Expect(other->world == keyframe.world, "keyframes {} and {} of two worlds share an edge",
                      keyframe.id.value, other->id.value);
  }
}

void CheckTree(const Map& map, const Keyframe& keyframe, Complaints& complaints) {
  for (const KeyframeId child : keyframe.children) {
    complaints.Expect(map.Find(child) != nullptr && map.At(child).parent == keyframe.id,
                      "keyframe {} is no child of {}", child.value, keyframe.id.value);
  }
  complaints.Expect(
      std::ranges::adjacent_find(keyframe.children, std::ranges::greater_equal()) == keyframe.children.end(),
      "the children of keyframe {} are out of order", keyframe.id.value);
  const KeyframeId root = map.Root(keyframe.world);
  const Keyframe* ancestor = &keyframe;
  for (std::size_t steps = 0; ancestor->parent.valid() && steps < map.keyframes().size(); ++steps) {
    const Keyframe* const parent = map.Find(ancestor->parent);
    if (!complaints.Expect(parent != nullptr && std::ranges::count(parent->children, ancestor->id) == 1,
                           "the parent of keyframe {} does not know it", ancestor->id.value)) {
      return;
    }
    complaints.Expect(parent->world == keyframe.world, "keyframe {} has an ancestor in another world",
                      keyframe.id.value);
    ancestor = parent;
  }
  complaints.Expect(ancestor->id == root, "keyframe {} hangs on {}, not on the root {} of its world", keyframe.id.value,
                    ancestor->id.value, root.value);
}

void CheckPoint(const Map& map, const MapPoint& point, Complaints& complaints) {
  const auto id = point.id.value;
  complaints.Expect(!point.observations.empty(), "nothing sees point {}", id);
  complaints.Expect(std::ranges::adjacent_find(point.observations, std::ranges::greater_equal(),
                                               &Observation::keyframe) == point.observations.end(),
                    "the observations of point {} are out of order", id);
  bool host_sees = false;
  for (const Observation& observation : point.observations) {
    const Keyframe* const keyframe = map.Find(observation.keyframe);
    if (complaints.Expect(keyframe != nullptr && observation.keypoint < keyframe->points.size() &&
                              keyframe->points[observation.keypoint] == point.id,
                          "keyframe {} does not know that its keypoint {} shows point {}", observation.keyframe.value,
                          observation.keypoint, id)) {
      host_sees |= keyframe->id == point.reference;
      complaints.Expect(keyframe->world == map.WorldOf(point.reference), "point {} is seen from two worlds", id);
      const bool counts = keyframe->IsLabeled() && keyframe->labels[observation.keypoint] != KeypointLabel::kNone;
      complaints.Expect(counts || observation.log_odds == 0, "point {} has evidence of a keypoint without label", id);
    }
  }
  complaints.Expect(host_sees, "the reference keyframe {} of point {} does not see it", point.reference.value, id);
  complaints.Expect(point.position.allFinite() && point.normal.allFinite() && point.max_distance_m >= 0 &&
                        point.min_distance_m <= point.max_distance_m,
                    "the geometry of point {} is out of range", id);
  const double p = map.probabilities().Get(point.id);
  complaints.Expect(p >= 0 && p <= 1, "point {} moves with a probability of {}", id, p);
}

}  // namespace

std::vector<std::string> Map::Validate() const {
  Complaints complaints;
  std::vector<std::size_t> keyframes_of(worlds_.size(), 0);
  complaints.Expect(std::ranges::is_sorted(keyframe_ids_), "the keyframes are out of order");
  complaints.Expect(keyframe_ids_.size() == static_cast<std::size_t>(std::ranges::count_if(
                                                keyframes_, [](const auto& one) { return one != nullptr; })),
                    "{} keyframes are listed, but not as many live", keyframe_ids_.size());
  for (const KeyframeId id : keyframe_ids_) {
    if (!complaints.Expect(Find(id) != nullptr, "keyframe {} is listed, but gone", id.value)) {
      continue;
    }
    const Keyframe& keyframe = At(id);
    complaints.Expect(keyframe.id == id, "keyframe {} is called {}", id.value, keyframe.id.value);
    CheckLinks(*this, keyframe, complaints);
    CheckEdges(*this, keyframe, complaints);
    CheckTree(*this, keyframe, complaints);
    ++keyframes_of.at(keyframe.world.index());
  }
  const std::vector<PointId> points = Points();
  complaints.Expect(points.size() == point_count(), "{} points live, {} are counted", points.size(), point_count());
  for (const PointId id : points) {
    complaints.Expect(At(id).id == id, "point {} is called {}", id.value, At(id).id.value);
    CheckPoint(*this, At(id), complaints);
  }
  for (std::size_t i = 0; i < worlds_.size(); ++i) {
    const World& world = worlds_[i];
    complaints.Expect(world.keyframes == keyframes_of[i], "world {} counts {} keyframes and has {}", i, world.keyframes,
                      keyframes_of[i]);
    complaints.Expect(world.root.valid() == (world.keyframes > 0), "world {} has {} keyframes and root {}", i,
                      world.keyframes, world.root.value);
    complaints.Expect(!world.root.valid() || (Find(world.root) != nullptr && At(world.root).world.index() == i),
                      "the root {} of world {} is elsewhere", world.root.value, i);
    complaints.Expect(!world.merged_into.valid() || world.keyframes == 0, "world {} was merged and has keyframes", i);
  }
  complaints.Expect(fused_.size() == replaced_by_.size(), "{} fusions are remembered in order, {} by id", fused_.size(),
                    replaced_by_.size());
  for (const auto& [from, to] : replaced_by_) {
    complaints.Expect(Find(from) == nullptr, "point {} was fused and lives", from.value);
    PointId now = from;
    std::size_t steps = 0;
    for (auto next = replaced_by_.find(now); next != replaced_by_.end() && steps <= fused_.size(); ++steps) {
      now = next->second;
      next = replaced_by_.find(now);
    }
    complaints.Expect(steps <= fused_.size(), "fusions of point {} go round in a circle", from.value);
  }
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    complaints.Expect((keyframes_[i] == nullptr) == erased_[i].has_value(), "keyframe {} is neither alive nor erased",
                      i);
    complaints.Expect(shared_[i] == 0, "a count of keyframe {} was left behind", i);
  }
  return complaints.Take();
}

}  // namespace rds
