// SPDX-License-Identifier: Apache-2.0
// What goes on while all of a large map is adjusted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "loop/loop_closer.h"
#include "system/backend.h"
#include "testing/ring_world.h"

namespace rds {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Half a kilometer of corridor with the drift of tracking.
struct LargeMap {
  LargeMap() {
    backend.Write([&](Map& map) { ids = world.AddTo(map, 0, kKeyframes); });
  }
  [[nodiscard]] bool Adjust(const std::function<bool()>& stop) {
    return closer.Adjust(backend, backend.Read([&](const Map& map) { return map.WorldOf(ids.front()); }), stop);
  }

  static constexpr int kKeyframes = 2000;
  RingWorld world{{.radius_m = 80, .keyframes = kKeyframes, .rounds = 1, .landmarks_per_m = 40, .drift = 0.01}};
  Backend backend{ScalePyramid(), {}, {}, false};
  LoopCloser closer{{}, ScalePyramid(), {}, false};
  std::vector<KeyframeId> ids;
};

// ccm_slam #26, ORB_SLAM2 #601, stella #237: an adjustment of minutes during which mapping waits, and which nothing
// ends.
TEST(LargeMap, MappingGoesOnWhileItIsAdjustedAndTheAdjustmentEndsWhenToldTo) {
  LargeMap large;
  std::atomic<bool> done = false;
  double adjustment_s = 0;
  bool adjusted = false;
  std::thread solver([&] {
    const auto start = Clock::now();
    adjusted = large.Adjust({});
    adjustment_s = SecondsSince(start);
    done = true;
  });
  int steps = 0;
  double longest_s = 0;
  std::vector<KeyframeId> added;
  while (!done) {
    // The newest view again and again: what a mapper does to a map with each keyframe.
    const auto view = large.world.Look(large.world.truth.back(), 900'000 + static_cast<std::uint64_t>(steps));
    const auto start = Clock::now();
    large.backend.Write([&](Map& map) {
      const Rigid3 pose = map.CameraFromWorld(large.ids.back());
      added.push_back(map.AddKeyframe(FrameId{static_cast<std::uint32_t>(LargeMap::kKeyframes + steps)}, 0, pose,
                                      view.data, map.WorldOf(large.ids.back())));
      for (std::uint32_t k = 0; k < view.landmarks.size(); ++k) {
        map.AddPoint(pose.Inverse() * view.data->keypoints()[k].PointIn(TestCamera()), added.back(), k);
      }
      map.UpdateCovisibility(added.back());
    });
    large.backend.PublishLocalMap(added.back());
    longest_s = std::max(longest_s, SecondsSince(start));
    ++steps;
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
  }
  solver.join();
  ASSERT_TRUE(adjusted);
  RecordProperty("adjustment_s", std::to_string(adjustment_s));
  RecordProperty("longest_wait_s", std::to_string(longest_s));
  EXPECT_GE(steps, 10);
  EXPECT_LT(longest_s, 0.25 * adjustment_s);
  large.backend.Read([](const Map& map) { EXPECT_THAT(map.Validate(), testing::IsEmpty()); });

  const auto start = Clock::now();
  int polled = 0;
  EXPECT_FALSE(large.Adjust([&] { return ++polled > 1; }));
  EXPECT_LT(SecondsSince(start), 0.5 * adjustment_s);
}

}  // namespace
}  // namespace rds
