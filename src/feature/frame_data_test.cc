// SPDX-License-Identifier: Apache-2.0
#include "feature/frame_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/random.h"

namespace rds {
namespace {

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.fx = camera.fy = 520;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

std::vector<Keypoint> RandomKeypoints(std::size_t count, double margin, std::uint64_t seed) {
  Random random(seed);
  std::vector<Keypoint> keypoints(count);
  for (Keypoint& k : keypoints) {
    k.x = static_cast<float>(random.Uniform(-margin, 640 + margin));
    k.y = static_cast<float>(random.Uniform(-margin, 480 + margin));
    k.octave = static_cast<std::uint8_t>(random.Index(8));
  }
  return keypoints;
}

TEST(ScalePyramid, HasPowersOfTheFactor) {
  const ScalePyramid pyramid(8, 1.2);
  ASSERT_EQ(pyramid.scale.size(), 8U);
  EXPECT_EQ(pyramid.scale[0], 1);
  EXPECT_NEAR(pyramid.scale[7], std::pow(1.2, 7), 1e-6);
  EXPECT_NEAR(pyramid.inverse_sigma2[3], 1 / std::pow(1.2, 6), 1e-12);
  EXPECT_THROW(ScalePyramid(0, 1.2), InvariantError);
  EXPECT_THROW(ScalePyramid(8, 1.0), InvariantError);
}

TEST(ScalePyramid, PredictsTheLevelFromTheDistance) {
  const ScalePyramid pyramid(8, 1.2);
  // At the largest distance the point shows at the finest level; each factor nearer is a level up.
  for (int level = 0; level < 8; ++level) {
    EXPECT_EQ(pyramid.PredictLevel(10, 10 / std::pow(1.2F, static_cast<float>(level) - 0.5F)), level);
  }
  EXPECT_EQ(pyramid.PredictLevel(10, 1000), 0);
  EXPECT_EQ(pyramid.PredictLevel(10, 0.01F), 7);
}

TEST(HammingDistance, CountsBits) {
  const Descriptor zero{};
  EXPECT_EQ(HammingDistance(zero, zero), 0);
  EXPECT_EQ(HammingDistance(zero, {1, 3, 7, ~std::uint64_t{0}}), 70);
}

TEST(FrameData, WindowSearchEqualsBruteForce) {
  // Some keypoints and windows lie outside the image, as undistortion and projection can put them there.
  const std::vector<Keypoint> keypoints = RandomKeypoints(2000, 15, 1);
  const FrameData frame(TestCamera(), keypoints, std::vector<Descriptor>(keypoints.size()));
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const auto x = static_cast<float>(random.Uniform(-60, 700));
    const auto y = static_cast<float>(random.Uniform(-60, 540));
    const auto radius = static_cast<float>(random.Uniform(0, 80));
    const int min_octave = static_cast<int>(random.Index(8));
    const int max_octave = static_cast<int>(random.Index(8));
    std::vector<std::size_t> expected;
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
      if (keypoints[k].octave >= min_octave && keypoints[k].octave <= max_octave &&
          std::abs(keypoints[k].x - x) < radius && std::abs(keypoints[k].y - y) < radius) {
        expected.push_back(k);
      }
    }
    std::vector<std::size_t> found;
    frame.ForEachInWindow(x, y, radius, min_octave, max_octave,
                          [&found](const FrameData::GridItem& item) { found.push_back(item.index); });
    ASSERT_THAT(found, testing::UnorderedElementsAreArray(expected));
  }
}

TEST(FrameData, KnowsItsBounds) {
  PinholeCamera camera = TestCamera();
  const FrameData plain(camera, {}, {});
  EXPECT_TRUE(plain.IsInImage(0, 0));
  EXPECT_TRUE(plain.IsInImage(639.9F, 479.9F));
  EXPECT_FALSE(plain.IsInImage(-0.1F, 10));
  EXPECT_FALSE(plain.IsInImage(640, 10));
  EXPECT_FALSE(plain.IsInImage(10, 480));
  // Barrel distortion squeezes the scene: undistorted, the image reaches farther.
  camera.distortion = {-0.2, 0, 0, 0, 0};
  const FrameData barrel(camera, {}, {});
  EXPECT_TRUE(barrel.IsInImage(-10, -10));
  EXPECT_TRUE(barrel.IsInImage(650, 490));
  EXPECT_FALSE(barrel.IsInImage(-1000, 10));
}

TEST(FrameData, KeepsKeypointsInOrder) {
  const std::vector<Keypoint> keypoints = RandomKeypoints(10, 0, 3);
  std::vector<Descriptor> descriptors(10);
  descriptors[7] = {1, 2, 3, 4};
  const FrameData frame(TestCamera(), keypoints, descriptors);
  ASSERT_EQ(frame.size(), 10U);
  EXPECT_EQ(frame.keypoints()[4].x, keypoints[4].x);
  EXPECT_EQ(frame.descriptors()[7], descriptors[7]);
}

TEST(FrameData, RefusesUnequalCounts) {
  EXPECT_THROW(FrameData(TestCamera(), std::vector<Keypoint>(2), std::vector<Descriptor>(1)), InvariantError);
  EXPECT_THROW(FrameData(TestCamera(), std::vector<Keypoint>(65535), std::vector<Descriptor>(65535)), InvariantError);
}

}  // namespace
}  // namespace rds
