// SPDX-License-Identifier: Apache-2.0
#include "eval/trajectory_matching.h"

#include <gmock/gmock.h>

#include "testing/matchers.h"

namespace rds {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Poses whose x is the time and that turn about z at a radian a second.
Trajectory At(const std::vector<double>& times) {
  Trajectory trajectory;
  for (const double t : times) {
    trajectory.push_back({t, {ExpSo3({0, 0, t}), {t, 0, 0}}});
  }
  return trajectory;
}

// Time of each match's estimate and of its ground truth.
std::vector<std::pair<double, double>> Times(const std::vector<MatchedPose>& matches) {
  std::vector<std::pair<double, double>> times;
  for (const MatchedPose& match : matches) {
    EXPECT_EQ(match.timestamp_s, match.estimate.translation.x());
    times.emplace_back(match.timestamp_s, match.ground_truth.translation.x());
  }
  return times;
}

using Pair = std::pair<double, double>;

TEST(MatchNearest, TakesTheNearestWithinTheLimit) {
  const auto matches = MatchNearest(At({1, 2, 3}), At({0.5, 0.995, 1.004, 2.011, 3.008}), 0.01);
  EXPECT_THAT(Times(matches), ElementsAre(Pair(1, 1.004), Pair(3, 3.008)));
}

TEST(MatchNearest, WalksTheSparserOne) {
  EXPECT_THAT(Times(MatchNearest(At({0.998, 1.001, 2, 3}), At({1, 3.001}), 0.01)),
              ElementsAre(Pair(1.001, 1), Pair(3, 3.001)));
  // As many of both: the estimate's poses are walked, so one of the ground truth's may serve twice.
  EXPECT_THAT(Times(MatchNearest(At({1, 1.004, 3}), At({1.002, 3.001, 3.005}), 0.01)),
              ElementsAre(Pair(1, 1.002), Pair(1.004, 1.002), Pair(3, 3.001)));
}

TEST(MatchNearest, OfEquallyNearTakesTheEarlier) {
  EXPECT_THAT(Times(MatchNearest(At({1}), At({0.75, 1.25}), 0.5)), ElementsAre(Pair(1, 0.75)));
}

TEST(MatchNearest, OfNothingIsNothing) {
  EXPECT_THAT(MatchNearest({}, At({1}), 1), IsEmpty());
  EXPECT_THAT(MatchNearest(At({1}), {}, 1), IsEmpty());
}

TEST(MatchInterpolated, GivesThePoseBetween) {
  const auto matches = MatchInterpolated(At({1, 1.125, 1.3}), At({1, 1.1, 1.2, 1.4}), 0.25);
  ASSERT_EQ(matches.size(), 3U);
  for (const MatchedPose& match : matches) {  // straight path and steady turning: interpolation is exact
    EXPECT_THAT(match.ground_truth, RigidNear(match.estimate, 1e-12, 1e-6));
  }
}

TEST(MatchInterpolated, LeavesOutEndsAndGaps) {
  const auto matches = MatchInterpolated(At({0.9, 1, 1.5, 2, 2.05, 2.1, 2.2}), At({1, 2, 2.1}), 0.2);
  EXPECT_THAT(Times(matches),
              ElementsAre(Pair(1, 1), Pair(2, 2), ::testing::Pair(2.05, ::testing::DoubleEq(2.05)), Pair(2.1, 2.1)));
}

}  // namespace
}  // namespace rds
