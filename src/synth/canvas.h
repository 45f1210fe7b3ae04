// SPDX-License-Identifier: Apache-2.0
// Painting textures: a canvas in meters with anti-aliased shapes and noise.
#pragma once

#include <cstdint>
#include <vector>

#include "base/random.h"

namespace rds::synthetic {

// Gray values, 0 to 255, as floats.
struct Color {
  float b = 0;
  float g = 0;
  float r = 0;
};

Color operator*(float scale, const Color& color);
Color Mix(const Color& a, const Color& b, float share_of_b);
// Hue in turns, saturation and value in [0, 1].
Color FromHsv(double hue, double saturation, double value);
// A color of any hue, with saturation and value drawn from the ranges.
Color RandomColor(Random& random, double low_saturation, double high_saturation, double low_value, double high_value);

// A picture of a rectangle of the given size in meters; x to the right, y down, texel (0, 0) covers the top left
// corner. Not thread-safe.
class Canvas {
 public:
  Canvas(double width_m, double height_m, double texel_m);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double width_m() const { return width_m_; }
  [[nodiscard]] double height_m() const { return height_m_; }
  [[nodiscard]] double texels_per_m_x() const { return width_ / width_m_; }
  [[nodiscard]] double texels_per_m_y() const { return height_ / height_m_; }
  Color& At(int x, int y) { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }
  [[nodiscard]] const Color& At(int x, int y) const { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }

  void Fill(const Color& color);
  // From `top` at the upper border to `bottom` at the lower one.
  void Gradient(const Color& top, const Color& bottom);
  // Rectangle about (x, y), turned by `angle` radians; meters.
  void Rect(double x, double y, double width, double height, const Color& color, double angle = 0, float alpha = 1);
  void Disc(double x, double y, double radius, const Color& color, float alpha = 1);
  void Line(double x0, double y0, double x1, double y1, double thickness, const Color& color);
  // Multiplies by 1 + amplitude * n, n in [-1, 1] being value noise of several octaves; `cell_x`, `cell_y` is the size
  // of the coarsest cell in meters, each octave is half as large and has half the weight.
  void Noise(std::uint64_t seed, double cell_x, double cell_y, int octaves, double amplitude);

 private:
  template <typename Coverage>
  void Paint(double x, double y, double reach_x, double reach_y, const Color& color, float alpha,
             const Coverage& coverage);

  double width_m_;
  double height_m_;
  int width_;
  int height_;
  std::vector<Color> pixels_;
};

}  // namespace rds::synthetic
