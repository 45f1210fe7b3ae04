#include "cli/statistics.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

TEST(Statistics, OfKnownSeries) {
  const Summary odd = Summarize({3, 1, 2});
  EXPECT_EQ(odd.count, 3U);
  EXPECT_DOUBLE_EQ(odd.median, 2);
  EXPECT_DOUBLE_EQ(odd.mean, 2);
  EXPECT_DOUBLE_EQ(odd.max, 3);
  EXPECT_DOUBLE_EQ(Summarize({1, 2, 3, 10}).median, 2.5);
  std::vector<double> hundred;
  for (int i = 0; i <= 100; ++i) {
    hundred.push_back(100 - i);
  }
  EXPECT_DOUBLE_EQ(Summarize(hundred).p95, 95);
  EXPECT_DOUBLE_EQ(Summarize({1, 2}).p95, 1.95);
  EXPECT_DOUBLE_EQ(Summarize({7}).p95, 7);
}

TEST(Statistics, EmptySeriesIsNull) {
  EXPECT_EQ(Summarize({}).count, 0U);
  EXPECT_TRUE(ToJson(Summarize({})).is_null());
  EXPECT_EQ(ToJson(Summarize({4})).dump(), R"({"median":4.0,"mean":4.0,"p95":4.0,"max":4.0})");
}

}  // namespace
}  // namespace rds
