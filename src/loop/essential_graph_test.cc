// SPDX-License-Identifier: Apache-2.0
#include "loop/essential_graph.h"

#include <gtest/gtest.h>

#include "testing/ring_world.h"

namespace rds {
namespace {

struct Scene {
  RingWorld world{{.turn_rad = 0.001}};
  Map map{ScalePyramid()};
  std::vector<KeyframeId> ids = world.AddTo(map, 0, 160);

  [[nodiscard]] LoopEdge TrueLoop(std::size_t from, std::size_t to) const {
    return {ids[from], ids[to], world.truth[to] * world.truth[from].Inverse(), 150};
  }
  [[nodiscard]] EssentialGraph Plan(const std::vector<LoopEdge>& loops) const {
    return PlanEssentialGraph(map, map.WorldOf(ids[0]), loops);
  }
};

TEST(EssentialGraph, HasFewEdgesAndHangsTogether) {
  const Scene scene;
  const EssentialGraph graph = scene.Plan({});
  EXPECT_EQ(graph.keyframes.size(), 160U);
  EXPECT_GE(graph.problem.edges.size(), 159U);
  EXPECT_LE(graph.problem.edges.size(), 4 * 160U);
  EXPECT_FALSE(graph.closes);
  EXPECT_FALSE(CloseGraph(graph).has_value());
}

TEST(EssentialGraph, ARightLoopBendsIt) {
  Scene scene;
  const double before = scene.world.Rmse(scene.map, scene.ids);
  const auto moves = CloseGraph(scene.Plan({scene.TrueLoop(2, 148)}));
  ASSERT_TRUE(moves.has_value());
  scene.map.Bend(*moves);
  EXPECT_LT(scene.world.Rmse(scene.map, scene.ids), 0.3 * before);
}

TEST(EssentialGraph, ProtestsAgainstAWrongLoop) {
  const Scene scene;
  LoopEdge wrong = scene.TrueLoop(2, 148);
  wrong.from = scene.ids[60];  // the same looks, a third of the ring away
  EXPECT_FALSE(CloseGraph(scene.Plan({wrong})).has_value());
  EXPECT_FALSE(CloseGraph(scene.Plan({scene.TrueLoop(2, 148), wrong})).has_value());
}

TEST(EssentialGraph, LoopsOfKeyframesThatAreGoneAreLeftOut) {
  Scene scene;
  const LoopEdge loop = scene.TrueLoop(2, 148);
  scene.map.EraseKeyframe(scene.ids[2]);
  const EssentialGraph graph = scene.Plan({loop});
  EXPECT_FALSE(graph.closes);
  for (const PoseGraphProblem::Edge& edge : graph.problem.edges) {
    EXPECT_FALSE(edge.robust);
  }
}

}  // namespace
}  // namespace rds
