#include "tracking/point_uses.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

TEST(PointUses, CountsUntilCleared) {
  PointUses uses;
  uses.CountVisible(PointId{7});
  uses.CountVisible(PointId{2});
  uses.CountVisible(PointId{7});
  uses.CountFound(PointId{7});
  const std::vector<PointUse> list = uses.List();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].point, PointId{7});
  EXPECT_EQ(list[0].visible, 2);
  EXPECT_EQ(list[0].found, 1);
  EXPECT_EQ(list[1].point, PointId{2});
  EXPECT_EQ(list[1].found, 0);
  uses.Clear();
  EXPECT_TRUE(uses.List().empty());
  uses.CountFound(PointId{7});
  ASSERT_EQ(uses.List().size(), 1U);
  EXPECT_EQ(uses.List()[0].visible, 0);
  EXPECT_EQ(uses.List()[0].found, 1);
}

}  // namespace
}  // namespace rds
