// SPDX-License-Identifier: Apache-2.0
// The graphs of the map: covisibility and spanning trees.
#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "map/map.h"

namespace rds {
namespace {

bool MoreShared(const Covisible& a, const Covisible& b) {
  return a.shared_points != b.shared_points ? a.shared_points > b.shared_points : a.keyframe < b.keyframe;
}

void Insert(std::vector<KeyframeId>& ids, KeyframeId id) { ids.insert(std::ranges::lower_bound(ids, id), id); }

}  // namespace

void Map::UpdateCovisibility(KeyframeId id) {
  Keyframe& keyframe = Mutable(id);
  // Only the keyframes that share a point are visited, however many there are.
  std::vector<Covisible> shared;
  for (const PointId point : keyframe.points) {
    if (!point.valid()) {
      continue;
    }
    for (const Observation& observation : At(point).observations) {
      if (shared_[observation.keyframe.index()]++ == 0) {
        shared.push_back({observation.keyframe, 0});
      }
    }
  }
  for (Covisible& other : shared) {
    other.shared_points = std::exchange(shared_[other.keyframe.index()], 0);
  }
  std::erase_if(shared, [&](const Covisible& other) { return other.keyframe == id; });
  std::ranges::sort(shared, MoreShared);
  for (std::size_t i = 1; i < shared.size(); ++i) {  // the best one counts in any case
    if (shared[i].shared_points < kMinShared) {
      shared.resize(i);
    }
  }
  for (const Covisible& old : std::exchange(keyframe.covisible, shared)) {
    RemoveEdge(Mutable(old.keyframe), id);
  }
  for (const Covisible& other : shared) {
    SetEdge(Mutable(other.keyframe), id, other.shared_points);
  }
  if (!keyframe.parent.valid() && id != Root(keyframe.world)) {
    // The most covisible older keyframe; without any, the one before it in its world.
    const auto is_older = [&](KeyframeId other) { return other < id && At(other).world == keyframe.world; };
    const auto covisible = std::ranges::find_if(keyframe.covisible, is_older, &Covisible::keyframe);
    if (covisible != keyframe.covisible.end()) {
      keyframe.parent = covisible->keyframe;
    } else {
      const auto self = std::ranges::lower_bound(keyframe_ids_, id);
      const auto before = std::find_if(std::reverse_iterator(self), keyframe_ids_.rend(), is_older);
      keyframe.parent = before != keyframe_ids_.rend() ? *before : Root(keyframe.world);
    }
    Insert(Mutable(keyframe.parent).children, id);
  }
}

void Map::SetEdge(Keyframe& keyframe, KeyframeId other, int shared_points) {
  RemoveEdge(keyframe, other);
  const Covisible edge{other, shared_points};
  keyframe.covisible.insert(std::ranges::lower_bound(keyframe.covisible, edge, MoreShared), edge);
}

void Map::RemoveEdge(Keyframe& keyframe, KeyframeId other) {
  std::erase_if(keyframe.covisible, [&](const Covisible& c) { return c.keyframe == other; });
}

std::vector<KeyframeId> Map::BestCovisible(KeyframeId id, std::size_t count) const {
  const std::vector<Covisible>& edges = At(id).covisible;
  std::vector<KeyframeId> best;
  for (std::size_t i = 0; i < std::min(count, edges.size()); ++i) {
    best.push_back(edges[i].keyframe);
  }
  return best;
}

std::vector<PointId> Map::PointsOf(std::span<const KeyframeId> keyframes) const {
  std::vector<PointId> points;
  for (const KeyframeId id : keyframes) {
    std::ranges::copy_if(At(id).points, std::back_inserter(points), &PointId::valid);
  }
  std::ranges::sort(points);
  const auto rest = std::ranges::unique(points);
  points.erase(rest.begin(), rest.end());
  return points;
}

void Map::AdoptChildren(Keyframe& erased) {
  // Each child takes as parent the keyframe it shares most points with among the erased one's parent and the children
  // that already have found one; that keeps the tree a tree.
  std::vector<KeyframeId> candidates = {erased.parent};
  std::vector<KeyframeId> orphans = erased.children;
  while (!orphans.empty()) {
    int most = -1;
    std::size_t child_index = 0;
    KeyframeId parent = erased.parent;
    for (std::size_t i = 0; i < orphans.size(); ++i) {
      for (const Covisible& edge : At(orphans[i]).covisible) {
        if (edge.shared_points > most && std::ranges::find(candidates, edge.keyframe) != candidates.end()) {
          most = edge.shared_points;
          child_index = i;
          parent = edge.keyframe;
        }
      }
    }
    const KeyframeId child = orphans[child_index];
    Mutable(child).parent = parent;
    Insert(Mutable(parent).children, child);
    candidates.push_back(child);
    orphans.erase(orphans.begin() + static_cast<std::ptrdiff_t>(child_index));
  }
}

void Map::EraseKeyframe(KeyframeId id) {
  Keyframe& keyframe = Mutable(id);
  Check(keyframe.parent.valid(), "the root of a spanning tree stays");
  for (const PointId point : std::vector<PointId>(keyframe.points)) {
    if (point.valid()) {
      Unlink(Mutable(point), id);
    }
  }
  for (const Covisible& edge : keyframe.covisible) {
    RemoveEdge(Mutable(edge.keyframe), id);
  }
  AdoptChildren(keyframe);
  Keyframe& parent = Mutable(keyframe.parent);
  std::erase(parent.children, id);
  erased_[id.index()] = Erased{parent.id, keyframe.camera_from_world * parent.camera_from_world.Inverse()};
  --worlds_[keyframe.world.index()].keyframes;
  keyframe_ids_.erase(std::ranges::lower_bound(keyframe_ids_, id));
  keyframes_[id.index()].reset();
}

KeyframeId Map::LivingAncestor(KeyframeId id) const {
  while (Find(id) == nullptr) {
    Check(id.index() < erased_.size() && erased_[id.index()].has_value(), "the keyframe was once in the map");
    id = erased_[id.index()]->parent;
  }
  return id;
}

Rigid3 Map::CameraFromWorld(KeyframeId id) const {
  const KeyframeId living = LivingAncestor(id);
  Rigid3 camera_from_ancestor;
  for (; id != living; id = erased_[id.index()]->parent) {
    camera_from_ancestor = camera_from_ancestor * erased_[id.index()]->self_from_parent;
  }
  return camera_from_ancestor * At(living).camera_from_world;
}

}  // namespace rds
