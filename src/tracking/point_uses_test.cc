#include "tracking/point_uses.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

std::shared_ptr<const LocalMap> MapOf(std::vector<PointId> ids) {
  auto map = std::make_shared<LocalMap>();
  map->ids = std::move(ids);
  return map;
}

TEST(PointUses, CountsUntilCleared) {
  PointUses uses;
  uses.Rebase(MapOf({PointId{2}, PointId{5}, PointId{7}}));
  uses.CountVisible(std::vector<std::uint32_t>{0, 2});
  uses.CountVisible(std::vector<std::uint32_t>{2});
  uses.CountFound(2);
  const std::vector<PointUse> list = uses.List();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].point, PointId{2});
  EXPECT_EQ(list[0].visible, 1);
  EXPECT_EQ(list[0].found, 0);
  EXPECT_EQ(list[1].point, PointId{7});
  EXPECT_EQ(list[1].visible, 2);
  EXPECT_EQ(list[1].found, 1);
  uses.Clear();
  EXPECT_TRUE(uses.List().empty());
  uses.CountFound(2);
  ASSERT_EQ(uses.List().size(), 1U);
  EXPECT_EQ(uses.List()[0].visible, 0);
  EXPECT_EQ(uses.List()[0].found, 1);
}

TEST(PointUses, KeepsTheCountsOfEarlierSnapshots) {
  PointUses uses;
  EXPECT_TRUE(uses.List().empty());
  uses.Rebase(MapOf({PointId{2}, PointId{5}}));
  uses.CountVisible(std::vector<std::uint32_t>{1});
  uses.Rebase(MapOf({PointId{5}, PointId{9}}));
  uses.CountVisible(std::vector<std::uint32_t>{0});
  uses.CountFound(0);
  const std::vector<PointUse> list = uses.List();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].point, PointId{5});
  EXPECT_EQ(list[0].visible, 1);
  EXPECT_EQ(list[0].found, 0);
  EXPECT_EQ(list[1].point, PointId{5});
  EXPECT_EQ(list[1].visible, 1);
  EXPECT_EQ(list[1].found, 1);
  uses.Clear();
  EXPECT_TRUE(uses.List().empty());
}

}  // namespace
}  // namespace rds
