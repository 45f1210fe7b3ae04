// SPDX-License-Identifier: Apache-2.0
#include "system/lanes.h"

#include <gtest/gtest.h>

#include <memory>

#include "base/error.h"
#include "base/time.h"
#include "runtime/worker.h"
#include "testing/board.h"

namespace rds {
namespace {

KeyframeCandidate CandidateThatHangsOnNothing(std::uint32_t frame) {
  KeyframeCandidate candidate;
  candidate.frame = FrameId{frame};
  candidate.data = SeeBoard({20, 40});
  candidate.points.assign(candidate.data->size(), PointId{});
  candidate.reference = KeyframeId{77};  // never was there
  return candidate;
}

TEST(Lane, AnErrorOfMappingEndsEveryWaitAndIsKept) {
  const auto shared = std::make_shared<Shared>(Options{}, ScalePyramid{}, nullptr);
  Worker mapping(Lane(shared, RunMapping));
  const Stopwatch watch;
  std::uint32_t frame = 0;
  while (shared->keyframes.Push(CandidateThatHangsOnNothing(frame++))) {  // waits for room, as with --rate 0
    ASSERT_LT(watch.Seconds(), 10);
  }
  EXPECT_LT(watch.Seconds(), 1);
  mapping.Join();
  EXPECT_TRUE(shared->failure.Happened());
  EXPECT_THROW(shared->failure.ThrowIfHappened(), InvariantError);
  EXPECT_TRUE(shared->waiting.Read([](const Waiting& waiting) { return waiting.closing; }));
}

TEST(Lane, TheFirstErrorCounts) {
  const auto shared = std::make_shared<Shared>(Options{}, ScalePyramid{}, nullptr);
  Lane(shared, [](Shared&) { throw InputError("first"); })();
  Lane(shared, [](Shared&) { throw InvariantError("second"); })();
  EXPECT_THROW(shared->failure.ThrowIfHappened(), InputError);
}

TEST(Lane, WithoutAnErrorNothingIsClosed) {
  const auto shared = std::make_shared<Shared>(Options{}, ScalePyramid{}, nullptr);
  Lane(shared, [](Shared&) {})();
  EXPECT_FALSE(shared->failure.Happened());
  EXPECT_TRUE(shared->keyframes.TryPush(CandidateThatHangsOnNothing(0)));
}

}  // namespace
}  // namespace rds
