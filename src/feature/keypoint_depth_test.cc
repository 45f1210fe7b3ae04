// SPDX-License-Identifier: Apache-2.0
#include "feature/keypoint_depth.h"

#include <gtest/gtest.h>

#include "testing/view.h"

namespace rds {
namespace {

Keypoint At(float x, float y, std::uint8_t octave = 0) {
  Keypoint keypoint;
  keypoint.x = keypoint.raw_x = x;
  keypoint.y = keypoint.raw_y = y;
  keypoint.octave = octave;
  return keypoint;
}

// A slope of 1 mm a pixel to the right at 1 m; a step of half a meter at column 400; nothing right of column 500.
Image16 Depth() {
  Image16 depth(640, 480);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 500; ++x) {
      depth.At(x, y) = static_cast<std::uint16_t>(5000 + 5 * x + (x >= 400 ? 2500 : 0));
    }
  }
  return depth;
}

TEST(LookUpDepth, DeviationIsTheSensorsAndWhatTheSlopeMakesOfAPixel) {
  PinholeCamera camera = TestCamera();
  camera.depth_noise = {0.003, 0.001};
  const Image16 depth = Depth();
  const ScalePyramid pyramid;
  std::vector<Keypoint> keypoints = {At(200, 100), At(200, 100, 4), At(398, 100), At(550, 100)};
  LookUpDepth(camera, DepthLookup(depth), true, pyramid, keypoints);
  EXPECT_FLOAT_EQ(keypoints[0].depth_m, 1.2F);
  const double sensor_m = 0.003 + 0.001 * 1.2 * 1.2;
  EXPECT_NEAR(keypoints[0].depth_sigma_m, std::hypot(sensor_m, 0.001 * (1.5 + 1)), 1e-6);
  // Coarse levels know less of where they are.
  EXPECT_NEAR(keypoints[1].depth_sigma_m, std::hypot(sensor_m, 0.001 * (1.5 + std::pow(1.2, 4))), 1e-6);
  // Beside a step the depth says next to nothing.
  EXPECT_GT(keypoints[2].depth_sigma_m, 0.3);
  EXPECT_TRUE(keypoints[2].at_edge);
  EXPECT_FALSE(keypoints[3].HasDepth());
}

}  // namespace
}  // namespace rds
