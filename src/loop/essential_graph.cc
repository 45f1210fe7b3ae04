// SPDX-License-Identifier: Apache-2.0
#include "loop/essential_graph.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

namespace rds {
namespace {

// What an edge of 100 shared points knows of the relative pose; fewer know less (one over the root of their number),
// more do not know more: drift is no white noise.
constexpr double kSigma_m = 0.005;
constexpr double kSigma_rad = 0.0035;
constexpr double kPoints = 100;
constexpr int kLeastPoints = 15;
constexpr std::size_t kStrongest = 3;  // edges of a keyframe beside the tree's
constexpr int kStrong = 50;            // shared points
constexpr double kMostChi2 = 22.5;     // 6 degrees of freedom: 99.9 %

PoseGraphProblem::Edge MakeEdge(std::uint32_t from, std::uint32_t to, const Rigid3& to_from_from, int points) {
  const double scale = std::max(1.0, std::sqrt(kPoints / std::max(points, kLeastPoints)));
  return {from, to, to_from_from, scale * kSigma_m, scale * kSigma_rad, false};
}

int SharedPoints(const Keyframe& keyframe, KeyframeId other) {
  const auto edge = std::ranges::find(keyframe.covisible, other, &Covisible::keyframe);
  return edge != keyframe.covisible.end() ? edge->shared_points : 0;
}

}  // namespace

EssentialGraph PlanEssentialGraph(const Map& map, WorldId world, std::span<const LoopEdge> loops) {
  EssentialGraph graph;
  graph.epoch = map.epoch();
  std::unordered_map<KeyframeId, std::uint32_t> pose_of;
  for (const KeyframeId id : map.keyframes()) {
    const Keyframe& keyframe = map.At(id);
    if (keyframe.world == world) {
      pose_of[id] = static_cast<std::uint32_t>(graph.keyframes.size());
      graph.keyframes.push_back(id);
      graph.problem.poses.push_back({keyframe.camera_from_world, map.IsRoot(id)});
    }
  }
  std::set<std::pair<KeyframeId, KeyframeId>> known;
  const auto connect = [&](const Keyframe& keyframe, KeyframeId other, int points) {
    if (known.insert(std::minmax(keyframe.id, other)).second) {
      graph.problem.edges.push_back(MakeEdge(pose_of.at(other), pose_of.at(keyframe.id),
                                             keyframe.camera_from_world * map.At(other).camera_from_world.Inverse(),
                                             points));
    }
  };
  for (const KeyframeId id : graph.keyframes) {
    const Keyframe& keyframe = map.At(id);
    if (keyframe.parent.valid()) {
      connect(keyframe, keyframe.parent, SharedPoints(keyframe, keyframe.parent));
    }
    for (std::size_t i = 0; i < std::min(kStrongest, keyframe.covisible.size()); ++i) {
      if (keyframe.covisible[i].shared_points >= kStrong) {
        connect(keyframe, keyframe.covisible[i].keyframe, keyframe.covisible[i].shared_points);
      }
    }
  }
  for (const LoopEdge& loop : loops) {
    const auto from = pose_of.find(loop.from);
    const auto to = pose_of.find(loop.to);
    if (from != pose_of.end() && to != pose_of.end()) {
      graph.problem.edges.push_back(MakeEdge(from->second, to->second, loop.to_from_from, loop.matches));
      graph.problem.edges.back().robust = &loop != &loops.back();  // the newest is judged by what it does
      graph.closes = graph.closes || &loop == &loops.back();
    }
  }
  return graph;
}

std::optional<std::vector<Map::WorldMove>> CloseGraph(const EssentialGraph& graph) {
  const std::vector<PoseGraphProblem::Edge>& edges = graph.problem.edges;
  if (!graph.closes) {
    return std::nullopt;
  }
  const PoseGraphResult result = OptimizePoseGraph(graph.problem);
  if (!result.usable) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].robust && result.chi2[i] > kMostChi2) {
      return std::nullopt;
    }
  }
  std::vector<Map::WorldMove> moves;
  for (std::size_t i = 0; i < graph.keyframes.size(); ++i) {
    moves.push_back({graph.keyframes[i], result.poses[i].Inverse() * graph.problem.poses[i].camera_from_world});
  }
  return moves;
}

}  // namespace rds
