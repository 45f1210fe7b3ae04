// SPDX-License-Identifier: Apache-2.0
#include "map/id_table.h"

#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "base/ids.h"

namespace rds {
namespace {

using Table = IdTable<PointId, int>;

TEST(IdTable, FindsWhatLives) {
  Table table;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(table.NextId(), PointId{static_cast<std::uint32_t>(i)});
    table.Add(std::make_unique<int>(i));
  }
  table.Erase(PointId{700});
  EXPECT_EQ(*table.Find(PointId{699}), 699);
  EXPECT_EQ(table.Find(PointId{700}), nullptr);
  EXPECT_EQ(table.Find(PointId{1000}), nullptr);
  EXPECT_EQ(table.Find(PointId{}), nullptr);
  EXPECT_EQ(table.size(), 999U);
  EXPECT_EQ(table.Ids().size(), 999U);
  EXPECT_EQ(table.Ids()[700], PointId{701});
  EXPECT_THROW(table.Erase(PointId{700}), InvariantError);
}

TEST(IdTable, WalksPastItsLimitAndAroundWhatStaysAlive) {
  constexpr std::size_t kPages = 8;
  Table table(kPages);
  table.Add(std::make_unique<int>(-1));  // lives for ever, on page 0
  std::deque<PointId> living;
  std::size_t freed = 0;
  for (int i = 0; i < 100'000; ++i) {
    const PointId id = table.NextId();
    ASSERT_TRUE(living.empty() || id > living.back());
    ASSERT_TRUE(id.index() < kIdsPerPage || id.index() / kIdsPerPage % kPages != 0) << "page 0 is in the way";
    table.Add(std::make_unique<int>(i));
    living.push_back(id);
    if (living.size() > 300) {
      table.Erase(living.front());
      living.pop_front();
    }
    ASSERT_EQ(*table.Find(id), i);
    freed += table.TakeFreedPages().size();
  }
  EXPECT_EQ(*table.Find(PointId{0}), -1);
  EXPECT_EQ(table.size(), 301U);
  EXPECT_NEAR(static_cast<double>(freed), 100'000.0 / kIdsPerPage, 4);
}

TEST(IdTable, APageIsFreedOnlyWhenNoMoreOfItsIdsWillBeGiven) {
  Table table;
  table.Add(std::make_unique<int>(0));
  table.Erase(PointId{0});
  EXPECT_TRUE(table.TakeFreedPages().empty());
  for (std::size_t i = 1; i < kIdsPerPage; ++i) {
    table.Add(std::make_unique<int>(0));
    table.Erase(PointId{static_cast<std::uint32_t>(i)});
  }
  EXPECT_EQ(table.TakeFreedPages().size(), 1U);
  EXPECT_TRUE(table.TakeFreedPages().empty());
}

TEST(IdTable, SaysWhenItIsFull) {
  Table table(2);
  for (std::size_t i = 0; i < 2 * kIdsPerPage; ++i) {
    table.Add(std::make_unique<int>(0));
  }
  EXPECT_THROW((void)table.NextId(), InvariantError);
  for (std::size_t i = 0; i < kIdsPerPage; ++i) {
    table.Erase(PointId{static_cast<std::uint32_t>(i)});
  }
  EXPECT_EQ(table.NextId(), PointId{2 * kIdsPerPage});
}

}  // namespace
}  // namespace rds
