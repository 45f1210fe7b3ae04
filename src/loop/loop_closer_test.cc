// SPDX-License-Identifier: Apache-2.0
#include "loop/loop_closer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "testing/matchers.h"
#include "testing/ring_world.h"
#include "testing/unlocked_map.h"

namespace rds {
namespace {

using testing::IsEmpty;

struct Scene {
  explicit Scene(const RingOptions& options) : world(options), map(ScalePyramid()), access(map) {}

  // Tells the closer of keyframes one by one, and adds up what it found.
  void Learn(const std::vector<KeyframeId>& ids) {
    for (const KeyframeId id : ids) {
      closer.Index(access, id);
      if (const auto closure = closer.Close(access, id)) {
        closures.push_back(*closure);
      }
    }
  }

  RingWorld world;
  Map map;
  UnlockedMap access;
  LoopCloser closer{LoopOptions{}, ScalePyramid(), {}, false};
  std::vector<Closure> closures;
};

TEST(LoopCloser, ClosesARingAndTakesTheDriftAway) {
  for (const double drift : {0.001, 0.004}) {  // rad from one keyframe to the next
    Scene scene({.turn_rad = drift});
    const std::vector<KeyframeId> ids = scene.world.AddTo(scene.map, 0, 160);
    const double before = scene.world.Rmse(scene.map, ids);
    scene.Learn(ids);
    ASSERT_FALSE(scene.closures.empty()) << drift;
    EXPECT_FALSE(scene.closures[0].merged.valid());
    EXPECT_LT(scene.world.Rmse(scene.map, ids), 0.25 * before) << drift << " " << before;
    EXPECT_LT(scene.world.RelativeError(scene.map, scene.closures[0].keyframe, scene.closures[0].place), 0.05);
    EXPECT_THAT(scene.map.Validate(), IsEmpty());
  }
}

}  // namespace
}  // namespace rds
