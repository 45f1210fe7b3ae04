#include "system/label_follower.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/error.h"
#include "testing/board.h"

namespace rds {
namespace {

LabelFollower::TrackedFrame Frame(std::uint32_t frame) { return {FrameId{frame}, SeeBoard({20, 40}), {}, nullptr}; }

// Waits for the labels of a frame, a few seconds at most.
bool Arrives(const LabelFollower& follower, FrameId frame) {
  for (int i = 0; i < 5000; ++i) {
    const auto newest = follower.Newest(frame);
    if (newest && newest->frame == frame) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(LabelFollowerTest, PublishesTheLabelsOfTheNewestFrame) {
  LabelFollower follower({}, {}, false);
  EXPECT_EQ(follower.Newest(FrameId{0}), nullptr);
  for (const std::uint32_t frame : {0U, 1U, 5U}) {
    follower.Offer(Frame(frame));
    EXPECT_TRUE(Arrives(follower, FrameId{frame}));
  }
}

TEST(LabelFollowerTest, WorksAtOnceInLockstep) {
  LabelFollower follower({}, {}, true);
  for (const std::uint32_t frame : {0U, 1U, 5U}) {
    follower.Offer(Frame(frame));
    ASSERT_NE(follower.Newest(FrameId{frame + 1}), nullptr);
    EXPECT_EQ(follower.Newest(FrameId{frame + 1})->frame, FrameId{frame});
  }
  EXPECT_NE(follower.Newest(FrameId{11}), nullptr);
  EXPECT_EQ(follower.Newest(FrameId{12}), nullptr);  // too old for it
}

TEST(LabelFollowerTest, PassesTheLabelsOfViewsOn) {
  LabelFollower follower({}, {}, true);
  const std::vector<KeypointLabel> labels(std::size_t{kBoardColumns} * kBoardRows, KeypointLabel::kStatic);
  LabelFollower::TrackedFrame frame = Frame(0);
  frame.views = std::make_shared<const std::vector<SeenView>>(1, MakeView(FrameId{0}, frame.data, {}, labels));
  follower.Offer(frame);
  EXPECT_TRUE(follower.Newest(FrameId{1})->labels[SampleAt(30, 30)].IsKnown());
}

TEST(LabelFollowerTest, NeverWaitsAndEndsWithFramesUnderWay) {
  LabelFollower follower({}, {}, false);
  for (std::uint32_t frame = 0; frame < 300; ++frame) {
    follower.Offer(Frame(frame));
  }
}

TEST(LabelFollowerTest, AnErrorOfItsThreadReachesTheCaller) {
  for (const bool lockstep : {true, false}) {
    LabelFollower follower({}, {}, lockstep);
    const DepthGrid without_samples{80, 60, {}};
    const auto broken = std::make_shared<const FrameData>(TestCamera(), std::vector<Keypoint>{},
                                                          std::vector<Descriptor>{}, without_samples);
    const auto offer_until_it_throws = [&] {
      for (std::uint32_t frame = 0; frame < 5000; ++frame) {
        follower.Offer({FrameId{frame}, broken, {}, nullptr});
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    };
    EXPECT_THROW(offer_until_it_throws(), InvariantError);
  }
}

}  // namespace
}  // namespace rds
