// SPDX-License-Identifier: Apache-2.0
// The graphs of the map: covisibility and spanning tree.
#include <algorithm>
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
  Keyframe& keyframe = At(id);
  std::vector<int> shared(keyframes_.size(), 0);
  for (const PointId point : keyframe.points) {
    if (!point.valid()) {
      continue;
    }
    for (const Observation& observation : At(point).observations) {
      ++shared[observation.keyframe.index()];
    }
  }
  shared[id.index()] = 0;
  const auto best = std::ranges::max_element(shared);
  for (const Covisible& old : std::vector<Covisible>(keyframe.covisible)) {
    if (shared[old.keyframe.index()] < kMinShared) {
      RemoveEdge(At(old.keyframe), id);
      RemoveEdge(keyframe, old.keyframe);
    }
  }
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (shared[i] >= kMinShared || (shared[i] > 0 && i == static_cast<std::size_t>(best - shared.begin()))) {
      SetEdge(keyframe, KeyframeId{static_cast<std::uint32_t>(i)}, shared[i]);
      SetEdge(*keyframes_[i], id, shared[i]);
    }
  }
  if (!keyframe.parent.valid() && id != keyframe_ids_.front()) {
    // The most covisible older keyframe; without any, the keyframe before this one.
    const auto older = std::ranges::find_if(keyframe.covisible, [&](const Covisible& c) { return c.keyframe < id; });
    keyframe.parent =
        older != keyframe.covisible.end() ? older->keyframe : *std::prev(std::ranges::lower_bound(keyframe_ids_, id));
    Insert(At(keyframe.parent).children, id);
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
    At(child).parent = parent;
    Insert(At(parent).children, child);
    candidates.push_back(child);
    orphans.erase(orphans.begin() + static_cast<std::ptrdiff_t>(child_index));
  }
}

void Map::EraseKeyframe(KeyframeId id) {
  Keyframe& keyframe = At(id);
  Check(keyframe.parent.valid(), "the root of the spanning tree stays");
  for (const PointId point : std::vector<PointId>(keyframe.points)) {
    if (point.valid()) {
      RemoveObservation(point, id);
    }
  }
  for (const Covisible& edge : std::vector<Covisible>(keyframe.covisible)) {
    RemoveEdge(At(edge.keyframe), id);
  }
  AdoptChildren(keyframe);
  Keyframe& parent = At(keyframe.parent);
  std::erase(parent.children, id);
  erased_[id.index()] = Erased{parent.id, keyframe.camera_from_world * parent.camera_from_world.Inverse()};
  std::erase(keyframe_ids_, id);
  keyframes_[id.index()].reset();
}

Rigid3 Map::CameraFromWorld(KeyframeId id) const {
  Rigid3 camera_from_ancestor;
  while (Find(id) == nullptr) {
    Check(id.index() < erased_.size() && erased_[id.index()].has_value(), "the keyframe was once in the map");
    camera_from_ancestor = camera_from_ancestor * erased_[id.index()]->self_from_parent;
    id = erased_[id.index()]->parent;
  }
  return camera_from_ancestor * At(id).camera_from_world;
}

}  // namespace rds
