// SPDX-License-Identifier: Apache-2.0
#include "synth/depth_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synth/synthetic_options.h"

namespace rds::synthetic {
namespace {

std::vector<float> Wall(const PinholeCamera& camera, double depth_m) {
  return std::vector<float>(static_cast<std::size_t>(camera.width * camera.height), static_cast<float>(depth_m));
}

struct Statistics {
  double mean_m = 0;
  double sigma_m = 0;
  int valid = 0;
};

Statistics Measure(const PinholeCamera& camera, double depth_m, std::uint64_t seed) {
  const Image16 image = MeasureDepth(Wall(camera, depth_m), camera, {}, seed);
  Statistics statistics;
  double square = 0;
  for (const std::uint16_t value : image.data) {
    if (value != 0) {
      ++statistics.valid;
      statistics.mean_m += value / camera.depth_scale;
      square += std::pow(value / camera.depth_scale - depth_m, 2);
    }
  }
  statistics.mean_m /= statistics.valid;
  statistics.sigma_m = std::sqrt(square / statistics.valid);
  return statistics;
}

TEST(DepthSensor, ExactDepthIsRoundedToUnits) {
  const PinholeCamera camera = MakeSyntheticCamera(64, 48);
  EXPECT_EQ(QuantizeDepth(Wall(camera, 1.23456), camera).At(5, 5), 6173);
  EXPECT_EQ(QuantizeDepth(Wall(camera, 0), camera).At(5, 5), 0);
  EXPECT_EQ(QuantizeDepth(Wall(camera, 14), camera).At(5, 5), 0);  // more than 16 bits hold
}

// sigma_z = z^2 / (f b) * sqrt(sigma_d^2 + step^2 / 12), averaged over where the depth falls between two steps.
TEST(DepthSensor, NoiseGrowsWithTheSquareOfDepth) {
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  const DepthNoise noise;
  const double sigma_px =
      std::sqrt(std::pow(noise.disparity_sigma_px, 2) + std::pow(noise.disparity_step_px, 2) / 12.0);
  for (const double depth_m : {1.0, 2.0, 3.0, 4.0}) {
    double sum = 0;
    double bias = 0;
    for (int i = 0; i < 20; ++i) {
      const double at_m = depth_m + 0.013 * i;
      const Statistics statistics = Measure(camera, at_m, static_cast<std::uint64_t>(i));
      EXPECT_EQ(statistics.valid, camera.width * camera.height);
      sum += std::pow(statistics.sigma_m / (at_m * at_m / camera.Bf() * sigma_px), 2) / 20;
      bias += (statistics.mean_m - at_m) / 20;
    }
    EXPECT_NEAR(std::sqrt(sum), 1.0, 0.12) << depth_m;
    EXPECT_LT(std::abs(bias), 0.004 * depth_m * depth_m / 4) << depth_m;
  }
}

TEST(DepthSensor, DepthComesInEighthsOfAPixelOfDisparity) {
  const PinholeCamera camera = MakeSyntheticCamera(160, 120);
  const Image16 image = MeasureDepth(Wall(camera, 2.71), camera, {}, 3);
  for (const std::uint16_t value : image.data) {
    const double eighths = 8 * camera.Bf() * camera.depth_scale / value;
    // The 16-bit rounding of the depth is worth less than a hundredth of a step here.
    ASSERT_NEAR(eighths, std::round(eighths), 0.02);
  }
}

TEST(DepthSensor, NothingTooNearOrTooFar) {
  const PinholeCamera camera = MakeSyntheticCamera(64, 48);
  EXPECT_EQ(Measure(camera, 0.39, 1).valid, 0);
  EXPECT_EQ(Measure(camera, 4.51, 1).valid, 0);
  EXPECT_EQ(Measure(camera, 4.49, 1).valid, 64 * 48);
}

TEST(DepthSensor, ShadowLeftOfANearerThing) {
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  std::vector<float> depth = Wall(camera, 3.0);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 150; x < 200; ++x) {
      depth[static_cast<std::size_t>(y * camera.width + x)] = 1.0F;
    }
  }
  const Image16 image = MeasureDepth(depth, camera, {}, 5);
  // The projector is at the right, so the wall's shadow lies left of the thing: f b (1 - 1 / 3) pixels of it.
  const int shadow = static_cast<int>(camera.Bf() * (1.0 - 1.0 / 3.0));
  int lost = 0;
  int right_lost = 0;
  for (int y = 20; y < 220; ++y) {
    for (int x = 150 - shadow + 2; x < 150; ++x) {
      lost += image.At(x, y) == 0 ? 1 : 0;
    }
    for (int x = 202; x < 202 + shadow; ++x) {
      right_lost += image.At(x, y) == 0 ? 1 : 0;
    }
    EXPECT_NE(image.At(150 - shadow - 4, y), 0);
  }
  EXPECT_EQ(lost, 200 * (shadow - 2));
  EXPECT_EQ(right_lost, 0);
  // Beside the right edge some pixels, not all, are lost.
  int edge_lost = 0;
  for (int y = 0; y < camera.height; ++y) {
    edge_lost += image.At(199, y) == 0 ? 1 : 0;
  }
  EXPECT_NEAR(edge_lost / 240.0, DepthNoise{}.edge_loss, 0.12);
}

TEST(ColorSensor, NoiseHasTheSigmaAskedFor) {
  const PinholeCamera camera = MakeSyntheticCamera(320, 240);
  const std::vector<float> gray(3U * 320U * 240U, 120.3F);
  const Image8 image = MeasureColor(gray, camera, kColorSigma, 8);
  double mean = 0;
  double square = 0;
  for (const std::uint8_t value : image.data) {
    mean += value;
    square += static_cast<double>(value) * value;
  }
  mean /= static_cast<double>(image.data.size());
  square /= static_cast<double>(image.data.size());
  EXPECT_NEAR(mean, 120.3, 0.03);
  EXPECT_NEAR(std::sqrt(square - mean * mean), std::sqrt(kColorSigma * kColorSigma + 1.0 / 12), 0.03);
  EXPECT_EQ(MeasureColor(gray, camera, 0, 8).data, std::vector<std::uint8_t>(gray.size(), 120));
  EXPECT_EQ(MeasureColor(gray, camera, 2, 8).data, image.data);
  EXPECT_NE(MeasureColor(gray, camera, 2, 9).data, image.data);
}

}  // namespace
}  // namespace rds::synthetic
