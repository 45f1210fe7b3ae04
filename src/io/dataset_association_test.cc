// SPDX-License-Identifier: Apache-2.0
#include "io/dataset_association.h"

#include <gmock/gmock.h>

namespace rds {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

std::vector<std::pair<std::size_t, std::size_t>> Associate(const std::vector<double>& first,
                                                           const std::vector<double>& second) {
  return AssociateByTime(first, second, 0.02);
}

TEST(AssociateByTime, TakesTheNearest) {
  EXPECT_THAT(Associate({1.00, 1.03, 1.06}, {0.99, 1.005, 1.025, 1.061}),
              ElementsAre(Pair(0, 1), Pair(1, 2), Pair(2, 3)));
}

TEST(AssociateByTime, UsesEachOnce) {
  // Both want 1.010: the nearer one gets it, the other has nothing else within the limit.
  EXPECT_THAT(Associate({1.000, 1.012}, {1.010}), ElementsAre(Pair(1, 0)));
  EXPECT_THAT(Associate({1.010}, {1.000, 1.012}), ElementsAre(Pair(0, 1)));
  // The nearer one gets it, the other falls back on its second choice.
  EXPECT_THAT(Associate({1.000, 1.012}, {0.985, 1.010}), ElementsAre(Pair(0, 0), Pair(1, 1)));
}

TEST(AssociateByTime, KeepsToTheLimit) {
  EXPECT_THAT(Associate({1.0, 2.0}, {1.021, 1.979}), IsEmpty());
  EXPECT_THAT(Associate({1.0, 2.0}, {1.019, 1.981}), ElementsAre(Pair(0, 0), Pair(1, 1)));
  EXPECT_THAT(Associate({}, {1.0}), IsEmpty());
  EXPECT_THAT(Associate({1.0}, {}), IsEmpty());
}

TEST(AssociateByTime, DoesNotDependOnTheDirection) {
  std::vector<double> first;
  std::vector<double> second;
  for (int i = 0; i < 200; ++i) {
    first.push_back(100 + i / 30.0 + 0.004 * ((i * 7) % 5));
    if (i % 11 != 0) {
      second.push_back(100.011 + i / 30.0 + 0.003 * ((i * 5) % 3));
    }
  }
  auto forward = Associate(first, second);
  auto backward = Associate(second, first);
  for (auto& [i, j] : backward) {
    std::swap(i, j);
  }
  EXPECT_EQ(forward, backward);
  EXPECT_GT(forward.size(), 150U);
}

}  // namespace
}  // namespace rds
