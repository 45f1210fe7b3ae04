// SPDX-License-Identifier: Apache-2.0
#include "geometry/depth_grid.h"

#include <gtest/gtest.h>

#include "base/error.h"
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

TEST(DepthGrid, WantsADepthForEachSample) {
  EXPECT_EQ(DepthGrid(3, 2, std::vector<float>(6)).size(), 6U);
  EXPECT_THROW(DepthGrid(3, 2, std::vector<float>(5)), InvariantError);
  EXPECT_TRUE(DepthGrid().empty());
}

TEST(DepthGrid, FindsSamplesByPixelAndPlace) {
  const DepthGrid grid(4, 3, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  EXPECT_EQ(grid.IndexOfPixel(8, 15.9F), 5U);
  EXPECT_EQ(grid.IndexOfPixel(32, 0), std::nullopt);  // in the margin that no sample covers
  EXPECT_EQ(grid.IndexWithin({1.5F, 1.2F, 3}), 5U);
  EXPECT_EQ(grid.IndexWithin({0.9F, 1.2F, 3}), std::nullopt);   // no sample to its left
  EXPECT_EQ(grid.IndexWithin({1.5F, 1.2F, -1}), std::nullopt);  // behind the camera
  EXPECT_EQ(grid.Place(2, 1).depth_m, 6);
  EXPECT_EQ(grid.Place(2, 1).column, 2.5F);
}

TEST(DepthGrid, VisitsSamplesAndThoseAroundOne) {
  const DepthGrid grid(4, 3, std::vector<float>(12));
  const auto visited = [&](auto run) {
    std::vector<std::size_t> order;
    run([&](int column, int row) { order.push_back(grid.Index(column, row)); });
    return order;
  };
  EXPECT_EQ(visited([&](auto visit) { grid.ForEach(visit, 2); }), (std::vector<std::size_t>{5, 7}));
  EXPECT_EQ(visited([&](auto visit) { grid.ForEachAround(3, 0, visit); }), (std::vector<std::size_t>{2, 3, 6, 7}));
}

TEST(SameSurface, IsARatioOfTheDepth) {
  EXPECT_TRUE(SameSurface(2, 2.05F, 0.03F));
  EXPECT_FALSE(SameSurface(2, 2.07F, 0.03F));
  EXPECT_TRUE(SameSurface(4, 4.1F, 0.03F));
}

}  // namespace
}  // namespace rds
