// SPDX-License-Identifier: Apache-2.0
// What holds for every executor, and what sets them apart.
#include "system/executor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#ifdef __linux__
#include <sched.h>
#endif

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/time.h"
#include "segmentation/mask.h"
#include "testing/board.h"

namespace rds {
namespace {

using namespace std::chrono_literals;

// All pixels static.
class PlainSegmenter final : public Segmenter {
 public:
  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    return std::vector<Image8>(inputs.size(), Image8(640, 480));
  }
  void Cancel() override {}
  [[nodiscard]] std::string Name() const override { return "plain"; }
};

KeyframeCandidate Candidate(std::uint32_t frame, KeyframeId reference = {}) {
  KeyframeCandidate candidate;
  candidate.frame = FrameId{frame};
  candidate.data = SeeBoard({20, 40}, std::vector<Keypoint>(3));
  candidate.points.assign(candidate.data->size(), PointId{});
  candidate.reference = reference;
  return candidate;
}
constexpr KeyframeId kNeverThere{77};

BacklogItem Item(std::uint32_t frame) {
  return {FrameId{frame}, 0.1 * frame, std::make_shared<const Image8>(640, 480),
          SeeBoard({20, 40}, std::vector<Keypoint>(3)), false};
}

TrackedFrame Tracked(std::uint32_t frame) { return {FrameId{frame}, SeeBoard({20, 40}), {}, nullptr}; }

// With a view that was not made as it should be: propagation throws.
TrackedFrame BrokenFrame(std::uint32_t frame) {
  TrackedFrame broken = Tracked(frame);
  broken.views = std::make_shared<const std::vector<DepthView>>(1, DepthView{FrameId{0}, broken.data, {}, {}, {}});
  return broken;
}

// Its keypoints do not fit its mask: applying the round throws.
BacklogItem ItemOfAnotherCamera(std::uint32_t frame) {
  PinholeCamera camera = TestCamera();
  camera.width = 320;
  return {FrameId{frame}, 0.1 * frame, std::make_shared<const Image8>(640, 480),
          std::make_shared<const FrameData>(camera, std::vector<Keypoint>{}, std::vector<Descriptor>{}), false};
}

struct Running {
  Options options;
  std::shared_ptr<Lanes> lanes;
  std::unique_ptr<Executor> executor;

  explicit Running(bool lockstep, bool wait_for_mapping = false) {
    options.system.lockstep = lockstep;
    options.system.wait_for_mapping = wait_for_mapping;
    options.semantic.finish_timeout_s = 20;
    lanes = std::make_shared<Lanes>(options, ScalePyramid{}, std::make_shared<PlainSegmenter>());
    executor = MakeExecutor(options, lanes);
  }
  // Until a condition holds; false after some seconds.
  template <typename Condition>
  static bool Soon(Condition condition) {
    const Stopwatch watch;
    while (!condition() && watch.Seconds() < 10) {
      std::this_thread::sleep_for(1ms);
    }
    return condition();
  }
};

class EveryExecutor : public testing::TestWithParam<bool> {
 protected:
  // Runs what may throw (in lockstep) as Slam does: an error that leaves the executor ends the run.
  template <typename Function>
  static void Guarded(Running& running, Function function) {
    try {
      function(*running.executor);
    } catch (...) {
      running.lanes->failure.Set(std::current_exception());
    }
  }
  // The run ends with an InvariantError, soon, and nothing waits for ever.
  static void ExpectEnded(Running& running) {
    EXPECT_TRUE(Running::Soon([&] { return running.lanes->failure.Happened(); }));
    EXPECT_THROW(running.lanes->failure.ThrowIfHappened(), InvariantError);
    const Stopwatch watch;
    running.executor->Finish();
    EXPECT_LT(watch.Seconds(), 5);
  }
};

TEST_P(EveryExecutor, AnErrorOfMappingEndsTheRun) {
  Running running(GetParam());
  Guarded(running, [](Executor& executor) {
    KeyframeCandidate candidate = Candidate(0, kNeverThere);
    std::ignore = executor.Map(candidate);
  });
  ExpectEnded(running);
}

TEST_P(EveryExecutor, AnErrorOfPropagationEndsTheRun) {
  Running running(GetParam());
  Guarded(running, [](Executor& executor) { executor.Propagate(BrokenFrame(0)); });
  ExpectEnded(running);
}

TEST_P(EveryExecutor, AnErrorOfLabelingEndsTheRun) {
  Running running(GetParam());
  Guarded(running, [](Executor& executor) {
    executor.Label(ItemOfAnotherCamera(1));
    for (std::uint32_t frame = 1; frame < 30; ++frame) {
      executor.BeginFrame(FrameId{frame});
    }
  });
  ExpectEnded(running);
}

TEST_P(EveryExecutor, MapsLabelsAndPropagates) {
  Running running(GetParam());
  Executor& executor = *running.executor;
  EXPECT_EQ(executor.NewestLabels(FrameId{0}), nullptr);
  KeyframeCandidate candidate = Candidate(0);
  ASSERT_TRUE(executor.Map(candidate));
  executor.Label(Item(0));
  executor.Propagate(Tracked(0));
  EXPECT_TRUE(Running::Soon([&] {
    const auto labels = executor.NewestLabels(FrameId{1});
    return labels && labels->frame == FrameId{0};
  }));
  executor.RestartPropagation();
  EXPECT_EQ(executor.NewestLabels(FrameId{1}), nullptr);
  executor.Finish();
  EXPECT_FALSE(running.lanes->failure.Happened());
  EXPECT_EQ(running.lanes->semantics.newest_labeled(), 0);
  running.lanes->backend.Read([](const Map& map) {
    EXPECT_EQ(map.keyframes().size(), 1U);
    EXPECT_TRUE(map.At(KeyframeId{0}).IsLabeled());
    EXPECT_THAT(map.Validate(), testing::IsEmpty());
  });
}

TEST_P(EveryExecutor, EndsInEveryStateWithoutFinish) {
  for (int offers = 0; offers < 20; ++offers) {
    Running running(GetParam());
    for (int i = 0; i < offers; ++i) {
      const auto frame = static_cast<std::uint32_t>(i);
      KeyframeCandidate candidate = Candidate(frame);
      if (running.executor->Map(candidate)) {
        running.executor->Label(Item(frame));
      }
      running.executor->Propagate(Tracked(frame));
    }
    const Stopwatch watch;
    running.executor.reset();
    EXPECT_LT(watch.Seconds(), 5);
  }
}

INSTANTIATE_TEST_SUITE_P(, EveryExecutor, testing::Bool(),
                         [](const auto& one) { return one.param ? "Lockstep" : "Threaded"; });

TEST(ThreadedExecutor, WhoWaitsForCapacityIsToldThatTheRunHasEnded) {
  Running running(false, true);
  const Stopwatch watch;
  KeyframeCandidate candidate = Candidate(0, kNeverThere);
  for (std::uint32_t frame = 1; running.executor->Map(candidate); ++frame) {
    candidate = Candidate(frame, kNeverThere);
    ASSERT_LT(watch.Seconds(), 10);
  }
  EXPECT_LT(watch.Seconds(), 5);
  EXPECT_TRUE(running.lanes->failure.Happened());
}

TEST(ThreadedExecutor, NeverWaitsForPropagation) {
  Running running(false);
  const auto frame = Tracked(0);
  const Stopwatch watch;
  for (std::uint32_t i = 0; i < 2000; ++i) {  // many times as many as may wait
    running.executor->Propagate({FrameId{i}, frame.data, {}, nullptr});
  }
  EXPECT_LT(watch.Seconds(), 1);
}

#ifdef __linux__
// Threads of this process that may not run on a core.
int ThreadsOff(int core) {
  int count = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    cpu_set_t cores;
    count +=
        sched_getaffinity(std::stoi(thread.path().filename()), sizeof cores, &cores) == 0 && !CPU_ISSET(core, &cores);
  }
  return count;
}

// Mapping and a full bundle adjustment had both cores of two, and one frame in twenty waited 4 ms for its turn.
TEST(ThreadedExecutor, TrackingHasItsCoreForItself) {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) != 0 || CPU_COUNT(&cores) < 2) {
    GTEST_SKIP() << "there is one core only";
  }
  Running running(false);
  int core = -1;
  int off = 0;
  while (core != sched_getcpu()) {  // moved meanwhile
    core = sched_getcpu();
    running.executor->BeginFrame(FrameId{0});
    off = ThreadsOff(core);
  }
  EXPECT_EQ(off, 4);  // mapping, places, full bundle adjustment, propagation
}
#endif

TEST(LockstepExecutor, DeliversLabelsASetNumberOfFramesLater) {
  Running running(true);
  KeyframeCandidate candidate = Candidate(0);
  ASSERT_TRUE(running.executor->Map(candidate));
  running.executor->Label(Item(0));
  std::uint32_t frame = 1;
  for (; running.lanes->semantics.newest_labeled() < 0 && frame < 100; ++frame) {
    running.executor->BeginFrame(FrameId{frame});
  }
  // Asked for at frame 1, delivered at the frame so many later; the loop goes on by one.
  EXPECT_EQ(static_cast<int>(frame), 1 + running.options.semantic.lockstep_delay_frames + 1);
}

}  // namespace
}  // namespace rds
