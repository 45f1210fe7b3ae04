// SPDX-License-Identifier: Apache-2.0
#include "synth/canvas.h"

#include <algorithm>
#include <cmath>

namespace rds::synthetic {
namespace {

// A value in [-1, 1] for a lattice point.
float LatticeValue(std::uint64_t seed, std::int64_t x, std::int64_t y) {
  std::uint64_t z = seed + static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL +
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1.0p-23F - 1.0F;
}

float SmoothStep(float x) { return x * x * (3.0F - 2.0F * x); }

}  // namespace

Color operator*(float scale, const Color& color) { return {scale * color.b, scale * color.g, scale * color.r}; }

Color Mix(const Color& a, const Color& b, float share_of_b) {
  return {a.b + share_of_b * (b.b - a.b), a.g + share_of_b * (b.g - a.g), a.r + share_of_b * (b.r - a.r)};
}

Color FromHsv(double hue, double saturation, double value) {
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + 6.0 * (hue - std::floor(hue)), 6.0);
    return static_cast<float>(255.0 * value * (1.0 - saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(1), channel(3), channel(5)};
}

Color RandomColor(Random& random, double low_saturation, double high_saturation, double low_value, double high_value) {
  const double hue = random.Uniform(0, 1);
  const double saturation = random.Uniform(low_saturation, high_saturation);
  return FromHsv(hue, saturation, random.Uniform(low_value, high_value));
}

Canvas::Canvas(double width_m, double height_m, double texel_m)
    : width_m_(width_m),
      height_m_(height_m),
      width_(std::max(2, static_cast<int>(std::lround(width_m / texel_m)))),
      height_(std::max(2, static_cast<int>(std::lround(height_m / texel_m)))),
      pixels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

void Canvas::Fill(const Color& color) { std::fill(pixels_.begin(), pixels_.end(), color); }

void Canvas::Gradient(const Color& top, const Color& bottom) {
  for (int y = 0; y < height_; ++y) {
    const Color color = Mix(top, bottom, (static_cast<float>(y) + 0.5F) / static_cast<float>(height_));
    std::fill_n(&At(0, y), width_, color);
  }
}

// Mixes in `color` where coverage(dx, dy), given meters from (x, y), says so: a signed distance in texels, negative
// inside.
template <typename Coverage>
void Canvas::Paint(double x, double y, double reach_x, double reach_y, const Color& color, float alpha,
                   const Coverage& coverage) {
  const double per_x = texels_per_m_x();
  const double per_y = texels_per_m_y();
  const int x0 = std::max(0, static_cast<int>(std::floor((x - reach_x) * per_x)) - 1);
  const int x1 = std::min(width_ - 1, static_cast<int>(std::ceil((x + reach_x) * per_x)) + 1);
  const int y0 = std::max(0, static_cast<int>(std::floor((y - reach_y) * per_y)) - 1);
  const int y1 = std::min(height_ - 1, static_cast<int>(std::ceil((y + reach_y) * per_y)) + 1);
  for (int row = y0; row <= y1; ++row) {
    const double dy = (row + 0.5) / per_y - y;
    for (int column = x0; column <= x1; ++column) {
      const double outside = coverage((column + 0.5) / per_x - x, dy) * per_x;
      const float share = alpha * static_cast<float>(std::clamp(0.5 - outside, 0.0, 1.0));
      if (share > 0) {
        At(column, row) = Mix(At(column, row), color, share);
      }
    }
  }
}

void Canvas::Rect(double x, double y, double width, double height, const Color& color, double angle, float alpha) {
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  const double reach_x = 0.5 * (std::abs(cosine) * width + std::abs(sine) * height);
  const double reach_y = 0.5 * (std::abs(sine) * width + std::abs(cosine) * height);
  Paint(x, y, reach_x, reach_y, color, alpha, [&](double dx, double dy) {
    return std::max(std::abs(cosine * dx + sine * dy) - 0.5 * width, std::abs(cosine * dy - sine * dx) - 0.5 * height);
  });
}

void Canvas::Disc(double x, double y, double radius, const Color& color, float alpha) {
  Paint(x, y, radius, radius, color, alpha,
        [&](double dx, double dy) { return std::sqrt(dx * dx + dy * dy) - radius; });
}

void Canvas::Line(double x0, double y0, double x1, double y1, double thickness, const Color& color) {
  Rect(0.5 * (x0 + x1), 0.5 * (y0 + y1), std::hypot(x1 - x0, y1 - y0), thickness, color, std::atan2(y1 - y0, x1 - x0));
}

void Canvas::Noise(std::uint64_t seed, double cell_x, double cell_y, int octaves, double amplitude) {
  double total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    total += std::pow(0.5, octave);
  }
  std::vector<float> sum(pixels_.size());
  std::vector<float> lattice;
  for (int octave = 0; octave < octaves; ++octave) {
    const double shrink = std::pow(0.5, octave);
    const auto weight = static_cast<float>(amplitude * shrink / total);
    const double step_x = 1.0 / (texels_per_m_x() * cell_x * shrink);  // cells in a texel
    const double step_y = 1.0 / (texels_per_m_y() * cell_y * shrink);
    const auto columns = static_cast<std::size_t>(step_x * width_) + 3;
    lattice.resize(columns);
    for (int y = 0; y < height_; ++y) {
      const double at_y = step_y * y;
      const auto cell = static_cast<std::int64_t>(at_y);
      const float mix = SmoothStep(static_cast<float>(at_y - static_cast<double>(cell)));
      for (std::size_t k = 0; k < columns; ++k) {
        const auto column = static_cast<std::int64_t>(k) + octave * 1000003;
        const float above = LatticeValue(seed, column, cell);
        lattice[k] = above + mix * (LatticeValue(seed, column, cell + 1) - above);
      }
      float* out = sum.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
      for (int x = 0; x < width_; ++x) {
        const double at_x = step_x * x;
        const auto k = static_cast<std::size_t>(at_x);
        const float left = lattice[k];
        out[x] +=
            weight * (left + SmoothStep(static_cast<float>(at_x - static_cast<double>(k))) * (lattice[k + 1] - left));
      }
    }
  }
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    pixels_[i] = (1.0F + sum[i]) * pixels_[i];
  }
}

}  // namespace rds::synthetic
