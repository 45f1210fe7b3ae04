// SPDX-License-Identifier: Apache-2.0
// The worlds of the map.
#include <algorithm>
#include <utility>

#include "base/error.h"
#include "map/map.h"

namespace rds {

WorldId Map::AddWorld() {
  worlds_.emplace_back();
  return WorldId{static_cast<std::uint32_t>(worlds_.size() - 1)};
}

WorldId Map::WorldOf(KeyframeId id) const { return At(LivingAncestor(id)).world; }

// Turns the links round between a keyframe and the root of its tree.
void Map::MakeRoot(KeyframeId id) {
  KeyframeId parent = std::exchange(Mutable(id).parent, KeyframeId{});
  for (KeyframeId child = id; parent.valid();) {
    Keyframe& old_parent = Mutable(parent);
    std::erase(old_parent.children, child);
    Keyframe& new_parent = Mutable(child);
    new_parent.children.insert(std::ranges::lower_bound(new_parent.children, parent), parent);
    child = parent;
    parent = std::exchange(old_parent.parent, new_parent.id);
  }
}

void Map::Merge(KeyframeId child, KeyframeId parent, const Rigid3& parent_from_child) {
  const WorldId from = At(child).world;
  const WorldId into = At(parent).world;
  Check(from != into, "two worlds are merged, not one with itself");
  const Rigid3 child_from_parent = parent_from_child.Inverse();
  for (const PointId id : Points()) {
    MapPoint& point = Mutable(id);
    if (At(point.reference).world == from) {
      point.position = parent_from_child * point.position;
      point.normal = parent_from_child.rotation * point.normal;
      ++point.revision;
    }
  }
  MakeRoot(child);
  for (const KeyframeId id : keyframe_ids_) {
    if (Keyframe& keyframe = Mutable(id); keyframe.world == from) {
      SetPose(id, keyframe.camera_from_world * child_from_parent);
      keyframe.world = into;
    }
  }
  Mutable(child).parent = parent;
  std::vector<KeyframeId>& children = Mutable(parent).children;
  children.insert(std::ranges::lower_bound(children, child), child);
  worlds_[into.index()].keyframes += std::exchange(worlds_[from.index()].keyframes, 0);
  worlds_[from.index()].root = KeyframeId{};
  worlds_[from.index()].merged_into = into;
}

}  // namespace rds
