// SPDX-License-Identifier: Apache-2.0
#include "semantic/backlog.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace rds {
namespace {

BacklogItem Item(std::uint32_t frame) { return {FrameId{frame}, 0, nullptr, nullptr, false}; }

std::vector<std::uint32_t> Frames(const std::vector<BacklogItem>& items) {
  std::vector<std::uint32_t> frames;
  for (const BacklogItem& item : items) {
    frames.push_back(item.frame.value);
  }
  return frames;
}

TEST(Backlog, BidirectionalTakesFrontAndBackAsInFigure7) {
  Backlog backlog(10);
  for (std::uint32_t i = 0; i < 5; ++i) {
    ASSERT_EQ(backlog.Push(Item(i)), 0);
  }
  const auto first = backlog.Select(SelectionMode::kBidirectional, 2);
  EXPECT_EQ(Frames(first), (std::vector<std::uint32_t>{0, 4}));
  EXPECT_TRUE(first[0].from_front);
  EXPECT_FALSE(first[1].from_front);
  EXPECT_EQ(Frames(backlog.Select(SelectionMode::kBidirectional, 2)), (std::vector<std::uint32_t>{1, 3}));
  // The last one is front and back at once, and is taken once.
  EXPECT_EQ(Frames(backlog.Select(SelectionMode::kBidirectional, 2)), (std::vector<std::uint32_t>{2}));
  EXPECT_TRUE(backlog.Select(SelectionMode::kBidirectional, 2).empty());
}

TEST(Backlog, OtherSelections) {
  Backlog backlog(10);
  for (std::uint32_t i = 0; i < 5; ++i) {
    ASSERT_EQ(backlog.Push(Item(i)), 0);
  }
  EXPECT_EQ(Frames(backlog.Select(SelectionMode::kSequential, 2)), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(Frames(backlog.Select(SelectionMode::kNewest, 2)), (std::vector<std::uint32_t>{4, 3}));
}

TEST(Backlog, MakesRoomInTheMiddle) {
  Backlog backlog(4);
  int dropped = 0;
  for (std::uint32_t i = 0; i < 100; ++i) {
    dropped += backlog.Push(Item(i));
  }
  EXPECT_EQ(dropped, 96);
  EXPECT_EQ(Frames(backlog.Select(SelectionMode::kBidirectional, 2)), (std::vector<std::uint32_t>{0, 99}));
}

}  // namespace
}  // namespace rds
