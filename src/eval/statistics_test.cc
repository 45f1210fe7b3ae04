// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rds {
namespace {

TEST(Statistics, OfKnownNumbers) {
  const std::vector<double> values = {4, 1, 3, 2};
  const Statistics s = Summarize(values);
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_EQ(s.min, 1);
  EXPECT_EQ(s.max, 4);
}

TEST(Statistics, OfOneAndOfNone) {
  const std::vector<double> one = {-3};
  EXPECT_EQ(Summarize(one).rmse, 3);
  EXPECT_EQ(Summarize(one).median, -3);
  EXPECT_EQ(Summarize(one).std, 0);
  EXPECT_EQ(Summarize({}).count, 0U);
  EXPECT_EQ(Summarize({}).rmse, 0);
}

TEST(Percentile, IsLinearBetweenNeighbors) {
  const std::vector<double> values = {30, 10, 20};
  EXPECT_DOUBLE_EQ(Percentile(values, 0), 10);
  EXPECT_DOUBLE_EQ(Percentile(values, 25), 15);
  EXPECT_DOUBLE_EQ(Percentile(values, 50), 20);
  EXPECT_DOUBLE_EQ(Percentile(values, 95), 29);
  EXPECT_DOUBLE_EQ(Percentile(values, 100), 30);
  EXPECT_EQ(Percentile({}, 50), 0);
}

}  // namespace
}  // namespace rds
