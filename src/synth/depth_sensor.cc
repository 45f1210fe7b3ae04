// SPDX-License-Identifier: Apache-2.0
#include "synth/depth_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/random.h"

namespace rds::synthetic {
namespace {

// Standard normal values by table: a draw costs a look-up. Not thread-safe.
class FastNormal {
 public:
  explicit FastNormal(std::uint64_t seed) : random_(seed) {}

  float Next() {
    if (left_ == 0) {
      bits_ = random_.Bits();
      left_ = 5;
    }
    --left_;
    const float value = Table()[bits_ & (kSize - 1)];
    bits_ >>= 12;
    return value;
  }

 private:
  static constexpr std::size_t kSize = 4096;

  // Quantiles of the normal distribution at (i + .5) / kSize, scaled to unit variance.
  static const std::array<float, kSize>& Table() {
    static const std::array<float, kSize> table = [] {
      std::array<double, kSize> quantiles{};
      double square = 0;
      for (std::size_t i = 0; i < kSize; ++i) {
        const double wanted = (static_cast<double>(i) + 0.5) / kSize;
        double low = -8;
        double high = 8;
        for (int step = 0; step < 50; ++step) {
          const double middle = 0.5 * (low + high);
          (0.5 * std::erfc(-middle / std::sqrt(2.0)) < wanted ? low : high) = middle;
        }
        quantiles[i] = low;
        square += low * low;
      }
      std::array<float, kSize> scaled{};
      for (std::size_t i = 0; i < kSize; ++i) {
        scaled[i] = static_cast<float>(quantiles[i] / std::sqrt(square / kSize));
      }
      return scaled;
    }();
    return table;
  }

  Random random_;
  std::uint64_t bits_ = 0;
  int left_ = 0;
};

std::uint16_t ToUnits(double depth_m, double depth_scale) {
  const double units = std::round(depth_m * depth_scale);
  return units >= 1 && units < 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

// Marks what the projector does not light. A pixel x with disparity d is lit by the projector's column x - d; going
// from the right, a pixel whose column has been passed already lies behind something nearer.
void MarkShadows(const float* depth_m, const PinholeCamera& camera, std::vector<char>& lost) {
  double leftmost = std::numeric_limits<double>::infinity();
  for (int x = camera.width - 1; x >= 0; --x) {
    if (depth_m[x] <= 0) {
      continue;
    }
    const double column = x - camera.Bf() / static_cast<double>(depth_m[x]);
    if (column > leftmost + 0.5) {
      lost[static_cast<std::size_t>(x)] = 1;
    }
    leftmost = std::min(leftmost, column);
  }
}

}  // namespace

Image16 QuantizeDepth(const std::vector<float>& depth_m, const PinholeCamera& camera) {
  Image16 image(camera.width, camera.height);
  std::transform(depth_m.begin(), depth_m.end(), image.data.begin(),
                 [&](float depth) { return ToUnits(static_cast<double>(depth), camera.depth_scale); });
  return image;
}

Image16 MeasureDepth(const std::vector<float>& depth_m, const PinholeCamera& camera, const DepthNoise& noise,
                     std::uint64_t seed) {
  Image16 image(camera.width, camera.height);
  FastNormal normal(seed);
  Random random(seed ^ 0xED6EULL);
  std::vector<char> lost(static_cast<std::size_t>(camera.width));
  const double bf = camera.Bf();
  for (int y = 0; y < camera.height; ++y) {
    const float* row = depth_m.data() + static_cast<std::ptrdiff_t>(y) * camera.width;
    const float* above = y > 0 ? row - camera.width : row;
    const float* below = y + 1 < camera.height ? row + camera.width : row;
    std::fill(lost.begin(), lost.end(), char{0});
    MarkShadows(row, camera, lost);
    for (int x = 0; x < camera.width; ++x) {
      const double disparity_noise = noise.disparity_sigma_px * static_cast<double>(normal.Next());
      const double depth = static_cast<double>(row[x]);
      if (lost[static_cast<std::size_t>(x)] != 0 || depth < noise.near_m || depth > noise.far_m) {
        continue;
      }
      const float left = row[std::max(x - 1, 0)];
      const float right = row[std::min(x + 1, camera.width - 1)];
      const double step = static_cast<double>(std::max({left, right, above[x], below[x]}) -
                                              std::min({left, right, above[x], below[x]}));
      if (step > 2.0 * noise.edge_jump * depth && random.Uniform(0, 1) < noise.edge_loss) {
        continue;
      }
      const double disparity = bf / depth + disparity_noise;
      const double measured = noise.disparity_step_px * std::round(disparity / noise.disparity_step_px);
      image.At(x, y) = measured > 0 ? ToUnits(bf / measured, camera.depth_scale) : std::uint16_t{0};
    }
  }
  return image;
}

Image8 MeasureColor(const std::vector<float>& color, const PinholeCamera& camera, double sigma, std::uint64_t seed) {
  Image8 image(camera.width, camera.height, 3);
  FastNormal normal(seed ^ 0xC0104ULL);
  const auto scale = static_cast<float>(sigma);
  for (std::size_t i = 0; i < color.size(); ++i) {
    const float value = color[i] + (sigma > 0 ? scale * normal.Next() : 0.0F);
    image.data[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
  }
  return image;
}

}  // namespace rds::synthetic
