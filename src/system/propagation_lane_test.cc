// SPDX-License-Identifier: Apache-2.0
#include "system/propagation_lane.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "testing/board.h"

namespace rds {
namespace {

TrackedFrame Frame(std::uint32_t frame) { return {FrameId{frame}, SeeBoard({20, 40}), {}, nullptr}; }

TEST(PropagationLane, HasTheLabelsOfTheNewestFrameUntilTheyAreTooOld) {
  PropagationLane lane({}, {});
  EXPECT_EQ(lane.Newest(FrameId{0}), nullptr);
  for (const std::uint32_t frame : {0U, 1U, 5U}) {
    lane.Propagate(Frame(frame));
    ASSERT_NE(lane.Newest(FrameId{frame + 1}), nullptr);
    EXPECT_EQ(lane.Newest(FrameId{frame + 1})->frame, FrameId{frame});
  }
  EXPECT_NE(lane.Newest(FrameId{11}), nullptr);
  EXPECT_EQ(lane.Newest(FrameId{12}), nullptr);
}

TEST(PropagationLane, PassesTheLabelsOfViewsOn) {
  PropagationLane lane({}, {});
  const std::vector<KeypointLabel> labels(std::size_t{kBoardColumns} * kBoardRows, KeypointLabel::kStatic);
  TrackedFrame frame = Frame(0);
  frame.views = std::make_shared<const std::vector<DepthView>>(1, MakeView(FrameId{0}, frame.data, {}, labels));
  lane.Propagate(frame);
  EXPECT_TRUE(lane.Newest(FrameId{1})->labels[SampleAt(30, 30)].IsKnown());
}

}  // namespace
}  // namespace rds
