// SPDX-License-Identifier: Apache-2.0
#include "system/propagation_lane.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/error.h"
#include "runtime/failure.h"
#include "testing/board.h"

namespace rds {
namespace {

PropagationLane::TrackedFrame Frame(std::uint32_t frame) { return {FrameId{frame}, SeeBoard({20, 40}), {}, nullptr}; }

// Waits for the labels of a frame, a few seconds at most.
bool Arrives(const PropagationLane& follower, FrameId frame) {
  for (int i = 0; i < 5000; ++i) {
    const auto newest = follower.Newest(frame);
    if (newest && newest->frame == frame) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

void NeverFails(std::exception_ptr /*error*/) { ADD_FAILURE(); }

TEST(PropagationLaneTest, PublishesTheLabelsOfTheNewestFrame) {
  PropagationLane follower({}, {}, false, NeverFails);
  EXPECT_EQ(follower.Newest(FrameId{0}), nullptr);
  for (const std::uint32_t frame : {0U, 1U, 5U}) {
    follower.Offer(Frame(frame));
    EXPECT_TRUE(Arrives(follower, FrameId{frame}));
  }
}

TEST(PropagationLaneTest, WorksAtOnceInLockstep) {
  PropagationLane follower({}, {}, true, NeverFails);
  for (const std::uint32_t frame : {0U, 1U, 5U}) {
    follower.Offer(Frame(frame));
    ASSERT_NE(follower.Newest(FrameId{frame + 1}), nullptr);
    EXPECT_EQ(follower.Newest(FrameId{frame + 1})->frame, FrameId{frame});
  }
  EXPECT_NE(follower.Newest(FrameId{11}), nullptr);
  EXPECT_EQ(follower.Newest(FrameId{12}), nullptr);  // too old for it
}

TEST(PropagationLaneTest, PassesTheLabelsOfViewsOn) {
  PropagationLane follower({}, {}, true, NeverFails);
  const std::vector<KeypointLabel> labels(std::size_t{kBoardColumns} * kBoardRows, KeypointLabel::kStatic);
  PropagationLane::TrackedFrame frame = Frame(0);
  frame.views = std::make_shared<const std::vector<DepthView>>(1, MakeView(FrameId{0}, frame.data, {}, labels));
  follower.Offer(frame);
  EXPECT_TRUE(follower.Newest(FrameId{1})->labels[SampleAt(30, 30)].IsKnown());
}

TEST(PropagationLaneTest, NeverWaitsAndEndsWithFramesUnderWay) {
  PropagationLane follower({}, {}, false, NeverFails);
  for (std::uint32_t frame = 0; frame < 300; ++frame) {
    follower.Offer(Frame(frame));
  }
}

TEST(PropagationLaneTest, AnErrorOfItsThreadIsTold) {
  const DepthGrid without_samples{80, 60, {}};
  const auto broken = std::make_shared<const FrameData>(TestCamera(), std::vector<Keypoint>{},
                                                        std::vector<Descriptor>{}, without_samples);
  PropagationLane lockstep({}, {}, true, NeverFails);
  EXPECT_THROW(lockstep.Offer({FrameId{0}, broken, {}, nullptr}), InvariantError);
  Failure failure;
  PropagationLane threaded({}, {}, false, [&](std::exception_ptr error) { failure.Set(std::move(error)); });
  for (std::uint32_t frame = 0; frame < 5000 && !failure.Happened(); ++frame) {
    threaded.Offer({FrameId{frame}, broken, {}, nullptr});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_THROW(failure.ThrowIfHappened(), InvariantError);
  threaded.Offer({FrameId{6000}, broken, {}, nullptr});  // left out
}

}  // namespace
}  // namespace rds
