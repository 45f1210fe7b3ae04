// SPDX-License-Identifier: Apache-2.0
#include "base/ids.h"

#include <gtest/gtest.h>

#include <type_traits>
#include <unordered_set>

namespace rds {
namespace {

static_assert(!std::is_convertible_v<KeyframeId, PointId>);
static_assert(!std::is_convertible_v<std::uint32_t, PointId>);
static_assert(!std::is_constructible_v<PointId, KeyframeId>);

TEST(Id, DefaultIsNone) {
  EXPECT_FALSE(PointId().valid());
  EXPECT_EQ(PointId(), PointId{PointId::kNone});
}

TEST(Id, OrdersAndComparesByValue) {
  EXPECT_TRUE(PointId{0}.valid());
  EXPECT_EQ(PointId{5}, PointId{5});
  EXPECT_NE(PointId{5}, PointId{6});
  EXPECT_LT(PointId{5}, PointId{6});
  EXPECT_LT(PointId{5}, PointId());
  EXPECT_EQ(PointId{5}.index(), 5U);
}

TEST(Id, Hashes) {
  const std::unordered_set<KeyframeId> ids = {KeyframeId{1}, KeyframeId{2}, KeyframeId{1}};
  EXPECT_EQ(ids.size(), 2U);
  EXPECT_TRUE(ids.contains(KeyframeId{2}));
}

}  // namespace
}  // namespace rds
