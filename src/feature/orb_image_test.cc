// SPDX-License-Identifier: Apache-2.0
#include "feature/orb_image.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "base/random.h"

namespace rds {
namespace {

GrayPlane RandomPlane(int width, int height, std::uint64_t seed) {
  Random random(seed);
  GrayPlane plane;
  plane.Resize(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      plane.Row(y)[x] = static_cast<std::uint8_t>(random.Index(256));
    }
  }
  return plane;
}

TEST(ToGray, RoundsTheWeightedSum) {
  Random random(1);
  Image8 image(67, 5, 3);
  for (std::uint8_t& value : image.data) {
    value = static_cast<std::uint8_t>(random.Index(256));
  }
  GrayPlane gray;
  ToGray(image, gray);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 67; ++x) {
      const std::uint8_t* bgr = &image.At(x, y);
      EXPECT_NEAR(gray.Row(y)[x], 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2], 1.2);
    }
  }
}

TEST(Shrinker, InterpolatesAtPixelCenters) {
  Shrinker shrinker;
  for (const double factor : {1.2, 1.5, 1.1, 2.0, 3.7}) {  // of which the largest do not fit the fast path
    for (const int width : {101, 64, 7}) {
      const GrayPlane from = RandomPlane(width, 33, 2);
      GrayPlane to;
      shrinker.Shrink(from, factor, to);
      ASSERT_EQ(to.width(), static_cast<int>(width / factor));
      ASSERT_EQ(to.height(), static_cast<int>(33 / factor));
      for (int y = 0; y < to.height(); ++y) {
        for (int x = 0; x < to.width(); ++x) {
          const double fx = (x + 0.5) * factor - 0.5;
          const double fy = (y + 0.5) * factor - 0.5;
          const int x0 = static_cast<int>(fx);
          const int y0 = static_cast<int>(fy);
          const auto at = [&](int u, int v) {
            return from.Row(std::min(v, from.height() - 1))[std::min(u, width - 1)];
          };
          const double upper = at(x0, y0) * (1 - fx + x0) + at(x0 + 1, y0) * (fx - x0);
          const double lower = at(x0, y0 + 1) * (1 - fx + x0) + at(x0 + 1, y0 + 1) * (fx - x0);
          ASSERT_NEAR(to.Row(y)[x], upper * (1 - fy + y0) + lower * (fy - y0), 3) << x << " " << y << " " << factor;
        }
      }
    }
  }
}

TEST(Blur, ConvolvesWithItsKernel) {
  constexpr std::array<int, 7> kKernel = {1, 2, 3, 4, 3, 2, 1};
  for (const int width : {100, 63, 7}) {
    const GrayPlane from = RandomPlane(width, 40, 3);
    GrayPlane to;
    std::vector<std::uint8_t> row;
    Blur(from, to, row);
    for (int y = 3; y < 37; ++y) {
      for (int x = 3; x < width - 3; ++x) {
        int sum = 0;
        for (int v = 0; v < 7; ++v) {
          for (int u = 0; u < 7; ++u) {
            sum += kKernel[static_cast<std::size_t>(u)] * kKernel[static_cast<std::size_t>(v)] *
                   from.Row(y + v - 3)[x + u - 3];
          }
        }
        // Every one of eight means rounds up by a quarter on average.
        ASSERT_NEAR(to.Row(y)[x], sum / 256.0 + 1.5, 2.5);
      }
    }
  }
}

}  // namespace
}  // namespace rds
