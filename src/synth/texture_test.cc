// SPDX-License-Identifier: Apache-2.0
#include "synth/texture.h"

#include <gtest/gtest.h>

namespace rds::synthetic {
namespace {

Canvas Ramp(int size) {
  Canvas canvas(size, size, 1.0);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      canvas.At(x, y) = {static_cast<float>(2 * x + 10), static_cast<float>(y + 20), 200};
    }
  }
  return canvas;
}

TEST(Texture, ReadsAPlaceInTexelsOfTheFinestLevel) {
  const Texture texture(Ramp(64));
  // The middle of texel (20, 31) is at (20.5, 31.5).
  for (const float lod : {-3.0F, 0.0F, 0.7F, 1.0F, 2.4F}) {
    const Float4 color = texture.Sample(20.5F, 31.5F, lod);
    EXPECT_NEAR(color[0], 2 * 20 + 10, 0.6) << lod;
    EXPECT_NEAR(color[1], 31 + 20, 0.6) << lod;
    EXPECT_NEAR(color[2], 200, 0.01) << lod;
  }
}

TEST(Texture, InterpolatesBetweenTexels) {
  const Texture texture(Ramp(64));
  EXPECT_NEAR(texture.Sample(20.75F, 31.5F, 0)[0], 2 * 20.25 + 10, 1e-3);
}

TEST(Texture, ALargeFilterGivesTheMean) {
  const Texture texture(Ramp(64));
  EXPECT_NEAR(texture.Sample(3.0F, 60.0F, 20)[0], 10 + 63, 3.0);
}

TEST(Texture, WrapsRoundOnlyIfAsked) {
  Canvas canvas(8, 2, 1.0);
  canvas.Fill({0, 0, 0});
  canvas.At(0, 0) = canvas.At(0, 1) = {100, 100, 100};
  EXPECT_NEAR(Texture(canvas, true).Sample(8.0F, 1.0F, 0)[0], 50, 1e-3);
  EXPECT_NEAR(Texture(canvas, true).Sample(0.0F, 1.0F, 0)[0], 50, 1e-3);
  EXPECT_NEAR(Texture(canvas, false).Sample(8.0F, 1.0F, 0)[0], 0, 1e-3);
  EXPECT_NEAR(Texture(canvas, false).Sample(0.0F, 1.0F, 0)[0], 100, 1e-3);
}

}  // namespace
}  // namespace rds::synthetic
