// SPDX-License-Identifier: Apache-2.0
// The worlds of the map.
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "base/error.h"
#include "map/map.h"

namespace rds {

WorldId Map::AddWorld() {
  worlds_.emplace_back();
  return WorldId{static_cast<std::uint32_t>(worlds_.size() - 1)};
}

WorldId Map::Resolve(WorldId world) const {
  while (worlds_.at(world.index()).merged_into.valid()) {
    world = worlds_[world.index()].merged_into;
  }
  return world;
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
  ++epoch_;
  Mutable(child).parent = parent;
  std::vector<KeyframeId>& children = Mutable(parent).children;
  children.insert(std::ranges::lower_bound(children, child), child);
  worlds_[into.index()].keyframes += std::exchange(worlds_[from.index()].keyframes, 0);
  worlds_[from.index()].root = KeyframeId{};
  worlds_[from.index()].merged_into = into;
}

void Map::Bend(std::span<const WorldMove> moves) {
  if (moves.empty()) {
    return;
  }
  std::unordered_map<KeyframeId, Rigid3> move_of;
  for (const WorldMove& move : moves) {
    move_of.insert_or_assign(move.keyframe, move.new_world_from_old_world);
  }
  const WorldId world = WorldOf(moves.front().keyframe);
  std::vector<KeyframeId> unnamed;
  for (const KeyframeId id : keyframe_ids_) {
    if (At(id).world != world) {
      continue;
    }
    KeyframeId ancestor = id;
    for (; ancestor.valid() && !move_of.contains(ancestor); ancestor = At(ancestor).parent) {
      unnamed.push_back(ancestor);
    }
    const Rigid3 move = ancestor.valid() ? move_of.at(ancestor) : Rigid3{};
    for (const KeyframeId follower : std::exchange(unnamed, {})) {
      move_of.emplace(follower, move);
    }
  }
  for (const PointId id : Points()) {
    MapPoint& point = Mutable(id);
    if (At(point.reference).world == world) {
      const Rigid3& move = move_of.at(point.reference);
      point.position = move * point.position;
      point.normal = move.rotation * point.normal;
      ++point.revision;
    }
  }
  for (const KeyframeId id : keyframe_ids_) {
    if (At(id).world == world) {
      SetPose(id, At(id).camera_from_world * move_of.at(id).Inverse());
    }
  }
  ++epoch_;
}

}  // namespace rds
