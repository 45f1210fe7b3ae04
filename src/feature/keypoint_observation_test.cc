// SPDX-License-Identifier: Apache-2.0
#include "feature/keypoint_observation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "feature/orb.h"
#include "testing/view.h"

namespace rds {
namespace {

// Corners everywhere: blocks of 4 x 4 pixels of random gray.
Image8 Speckled(int width, int height) {
  Random random(12);
  Image8 image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.At(x, y) = y % 4 != 0   ? image.At(x, y - 1)
                       : x % 4 != 0 ? image.At(x - 1, y)
                                    : static_cast<std::uint8_t>(random.Index(256));
    }
  }
  return image;
}

TEST(OrbExtractor, FindsKeypointsWhereASurfaceEnds) {
  const Image8 image = Speckled(640, 480);
  const auto edges_in = [&](const OrbOptions& options, int near_mm) {
    Image16 depth(640, 480);
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {  // a hole, a slope, and a jump of a fifth
        const int depth_mm = x < 100 ? 0 : near_mm * (x < 320 ? 10 : 12) / 10 + y / 4;
        depth.At(x, y) = static_cast<std::uint16_t>(depth_mm * TestCamera().depth_scale / 1000);
      }
    }
    int edges = 0;
    const FrameData frame = OrbExtractor(options).Extract(TestCamera(), image, depth);
    for (const Keypoint& k : frame.keypoints()) {
      const auto x = static_cast<int>(std::lround(k.raw_x));
      const bool at_hole = k.HasDepth() && x < 100 + 6 && near_mm < 1100;
      const bool at_jump = x >= 320 - 6 && x < 320 + 6;
      edges += k.at_edge ? 1 : 0;
      EXPECT_EQ(k.at_edge, options.depth_edges && (at_hole || at_jump)) << x << " at " << near_mm << " mm";
    }
    return edges;
  };
  OrbOptions without;
  without.depth_edges = false;
  const int far = edges_in({}, 1500);
  EXPECT_GT(far, 5);
  EXPECT_GT(edges_in({}, 900), far);
  EXPECT_EQ(edges_in(without, 900), 0);
}

TEST(ObservationOf, SaysLessOfWhereASurfaceEnds) {
  const ScalePyramid pyramid;
  Keypoint keypoint;
  keypoint.x = 10;
  keypoint.y = 20;
  keypoint.depth_m = 2;
  keypoint.depth_sigma_m = 0.01F;
  keypoint.octave = 2;
  const PixelObservation firm = ObservationOf(keypoint, pyramid, 0.7);
  EXPECT_EQ(firm.pixel, Eigen::Vector2d(10, 20));
  EXPECT_DOUBLE_EQ(firm.inverse_depth, 0.5);
  // One standard deviation of the depth, 1 / 2.01 - 1 / 2 to first order, counts as one of the position.
  EXPECT_NEAR(firm.depth_px * 0.01 / (2 * 2) * std::sqrt(firm.inverse_sigma2), 1, 1e-6);
  EXPECT_EQ(firm.weight, 0.7);
  EXPECT_DOUBLE_EQ(firm.inverse_sigma2, pyramid.inverse_sigma2[2]);
  keypoint.at_edge = true;
  EXPECT_DOUBLE_EQ(ObservationOf(keypoint, pyramid, 0.7).inverse_sigma2, kEdgeInformation * firm.inverse_sigma2);
}

}  // namespace
}  // namespace rds
