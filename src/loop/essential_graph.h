// SPDX-License-Identifier: Apache-2.0
// The pose graph of a world: what a loop bends.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "map/map.h"
#include "optim/pose_graph.h"

namespace rds {

// A relative pose of two keyframes that was found by recognizing a place.
struct LoopEdge {
  KeyframeId from;
  KeyframeId to;
  Rigid3 to_from_from;
  int matches = 0;
};

// A copy of the poses of a world and of how they hang together: its spanning tree and the strongest edges of the
// covisibility graph, as they are now (the essential graph: Mur-Artal et al., T-RO 2015, section III-D, with few edges
// for each keyframe), and loops.
struct EssentialGraph {
  PoseGraphProblem problem;
  std::vector<KeyframeId> keyframes;  // one for each pose of the problem
  std::uint32_t epoch = 0;
  bool closes = false;  // the newest loop is in it
};

// Loops with keyframes that are gone or of another world are left out; the last one is the newest.
[[nodiscard]] EssentialGraph PlanEssentialGraph(const Map& map, WorldId world, std::span<const LoopEdge> loops);

// How the keyframes must move so that the loops close. Nothing where the graph protests: an edge would have to give
// more than it can, or the newest loop is not fulfilled; then that loop is wrong.
[[nodiscard]] std::optional<std::vector<Map::WorldMove>> CloseGraph(const EssentialGraph& graph);

}  // namespace rds
