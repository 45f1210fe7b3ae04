// SPDX-License-Identifier: Apache-2.0
#include "tracking/point_uses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rds {
namespace {

std::shared_ptr<const LocalMap> MapOf(std::vector<PointId> ids) {
  auto map = std::make_shared<LocalMap>();
  map->ids = std::move(ids);
  return map;
}

auto IsUse(PointId point, int visible, int found) {
  return testing::AllOf(testing::Field(&PointUse::point, point), testing::Field(&PointUse::visible, visible),
                        testing::Field(&PointUse::found, found));
}

TEST(PointUses, CountsUntilCleared) {
  PointUses uses;
  uses.Rebase(MapOf({PointId{2}, PointId{5}, PointId{7}}));
  uses.CountVisible(std::vector<std::uint32_t>{0, 2});
  uses.CountVisible(std::vector<std::uint32_t>{2});
  uses.CountFound(2);
  EXPECT_THAT(uses.List(), testing::ElementsAre(IsUse(PointId{2}, 1, 0), IsUse(PointId{7}, 2, 1)));
  uses.Clear();
  EXPECT_TRUE(uses.List().empty());
  uses.CountFound(2);
  EXPECT_THAT(uses.List(), testing::ElementsAre(IsUse(PointId{7}, 0, 1)));
}

TEST(PointUses, KeepsTheCountsOfEarlierSnapshots) {
  PointUses uses;
  EXPECT_TRUE(uses.List().empty());
  uses.Rebase(MapOf({PointId{2}, PointId{5}}));
  uses.CountVisible(std::vector<std::uint32_t>{1});
  uses.Rebase(MapOf({PointId{5}, PointId{9}}));
  uses.CountVisible(std::vector<std::uint32_t>{0});
  uses.CountFound(0);
  EXPECT_THAT(uses.List(), testing::ElementsAre(IsUse(PointId{5}, 1, 0), IsUse(PointId{5}, 1, 1)));
  uses.Clear();
  EXPECT_TRUE(uses.List().empty());
}

}  // namespace
}  // namespace rds
