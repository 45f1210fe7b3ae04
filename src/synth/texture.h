// SPDX-License-Identifier: Apache-2.0
// Mip-mapped textures.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "synth/canvas.h"

namespace rds::synthetic {

// Four floats in one register: blue, green, red, unused.
using Float4 = float __attribute__((vector_size(16)));

// An image with its pyramid of halves, read with linear interpolation within and between levels. Immutable; safe to
// share between threads. (Williams, "Pyramidal parametrics", SIGGRAPH 1983.)
class Texture {
 public:
  // `wrap_x` joins the left and the right border; the canvas's width in texels should then be a power of two.
  explicit Texture(const Canvas& canvas, bool wrap_x = false);

  [[nodiscard]] float width() const { return static_cast<float>(levels_.front().width); }
  [[nodiscard]] float height() const { return static_cast<float>(levels_.front().height); }

  // Color at a place in texels of the finest level (texel i covers [i, i + 1)); `lod` is the base-2 logarithm of the
  // filter's width in texels.
  [[nodiscard]] Float4 Sample(float x, float y, float lod) const {
    if (lod <= 0) {
      return Bilinear(levels_.front(), x, y);
    }
    const float last = static_cast<float>(levels_.size() - 1);
    const float clamped = std::min(lod, last);
    const auto level = static_cast<std::size_t>(clamped);
    const Float4 fine = Bilinear(levels_[level], x * levels_[level].scale, y * levels_[level].scale);
    const float share = clamped - static_cast<float>(level);
    if (share == 0) {
      return fine;
    }
    const Level& next = levels_[level + 1];
    return fine + share * (Bilinear(next, x * next.scale, y * next.scale) - fine);
  }

 private:
  using Texel = std::uint8_t __attribute__((vector_size(4)));
  struct Level {
    int width = 0;
    int height = 0;
    float scale = 1;  // texels of this level in one of the finest
    std::vector<std::array<std::uint8_t, 4>> texels;
  };

  static Float4 Load(const std::array<std::uint8_t, 4>& texel) {
    Texel bytes;
    std::memcpy(&bytes, texel.data(), sizeof(bytes));
    return __builtin_convertvector(bytes, Float4);
  }

  [[nodiscard]] Float4 Bilinear(const Level& level, float x, float y) const {
    // The offset keeps the argument positive, so that truncation rounds down.
    const float from_x = x - 0.5F + 16.0F;
    const float from_y = y - 0.5F + 16.0F;
    const int whole_x = static_cast<int>(from_x);
    const int whole_y = static_cast<int>(from_y);
    const float share_x = from_x - static_cast<float>(whole_x);
    const float share_y = from_y - static_cast<float>(whole_y);
    int x0 = whole_x - 16;
    int x1 = x0 + 1;
    if (wrap_x_) {
      x0 = x0 < 0 ? x0 + level.width : x0;
      x1 = x1 >= level.width ? x1 - level.width : x1;
    }
    x0 = std::clamp(x0, 0, level.width - 1);
    x1 = std::clamp(x1, 0, level.width - 1);
    const int y0 = std::clamp(whole_y - 16, 0, level.height - 1);
    const int y1 = std::clamp(whole_y - 15, 0, level.height - 1);
    const auto* upper = level.texels.data() + static_cast<std::ptrdiff_t>(y0) * level.width;
    const auto* lower = level.texels.data() + static_cast<std::ptrdiff_t>(y1) * level.width;
    const Float4 top = Load(upper[x0]) + share_x * (Load(upper[x1]) - Load(upper[x0]));
    const Float4 bottom = Load(lower[x0]) + share_x * (Load(lower[x1]) - Load(lower[x0]));
    return top + share_y * (bottom - top);
  }

  std::vector<Level> levels_;
  bool wrap_x_;
};

}  // namespace rds::synthetic
