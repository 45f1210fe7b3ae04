// SPDX-License-Identifier: Apache-2.0
#include "propagation/grid_warp.h"

#include <gtest/gtest.h>

#include "testing/view.h"

namespace rds {
namespace {

GridPlace PlaceOf(const Keypoint& keypoint) {
  return {keypoint.raw_x / kDepthGridStep, keypoint.raw_y / kDepthGridStep, keypoint.depth_m};
}

TEST(GridWarp, TakesAPlaceToWhereTheOtherViewSeesIt) {
  const Rigid3 from_world(ExpSo3({0.1, -0.2, 0.05}), {0.3, -0.1, 0.2});
  const Rigid3 to_world(ExpSo3({-0.05, 0.1, 0.3}), {-0.2, 0.4, 0.1});
  const GridWarp warp(TestCamera(), to_world * from_world.Inverse());
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, 3), Eigen::Vector3d(0.5, -0.4, 2), Eigen::Vector3d(-1, 1, 5)}) {
    const GridPlace there = warp(PlaceOf(See(from_world, point)));
    const GridPlace expected = PlaceOf(See(to_world, point));
    EXPECT_NEAR(there.column, expected.column, 1e-3);
    EXPECT_NEAR(there.row, expected.row, 1e-3);
    EXPECT_NEAR(there.depth_m, expected.depth_m, 1e-4);
  }
}

TEST(GridWarp, TellsWhatIsBehindTheOtherCamera) {
  Rigid3 to_from_from;
  to_from_from.translation = {0, 0, -2};  // two meters ahead
  const GridWarp warp(TestCamera(), to_from_from);
  EXPECT_GT(warp({40, 30, 3}).depth_m, 0);
  EXPECT_LT(warp({40, 30, 1}).depth_m, 0);
}

}  // namespace
}  // namespace rds
