// SPDX-License-Identifier: Apache-2.0
#include "synth/paint_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rds::synthetic {

void PaintText(Canvas& canvas, Random& random, double x, double y, double width, double height, double line,
               const Color& ink) {
  for (double at = y + 0.5 * line; at + 0.5 * line < y + height; at += line) {
    double left = x;
    const double end = x + width * random.Uniform(0.55, 1.0);
    while (left < end) {
      const double word = std::min(random.Uniform(0.8, 3.2) * line, end - left);
      canvas.Rect(left + 0.5 * word, at, word, 0.45 * line, ink);
      left += word + 0.5 * line;
    }
  }
}

void PaintShapes(Canvas& canvas, Random& random, int count, double largest) {
  for (int i = 0; i < count; ++i) {
    const double size = largest * std::pow(0.12, static_cast<double>(i) / count) * random.Uniform(0.6, 1.0);
    const double x = random.Uniform(0, canvas.width_m());
    const double y = random.Uniform(0, canvas.height_m());
    const Color color = RandomColor(random, 0.2, 0.8, 0.15, 0.95);
    if (random.Index(3) == 0) {
      canvas.Disc(x, y, 0.5 * size, color);
      if (random.Index(2) == 0) {
        canvas.Disc(x, y, 0.28 * size, RandomColor(random, 0.1, 0.7, 0.15, 0.95));
      }
    } else {
      canvas.Rect(x, y, size, size * random.Uniform(0.25, 1.0), color, random.Uniform(0, std::numbers::pi));
    }
  }
}

void PaintBorder(Canvas& canvas, double thickness, const Color& color) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Rect(0.5 * w, 0.5 * thickness, w, thickness, color);
  canvas.Rect(0.5 * w, h - 0.5 * thickness, w, thickness, color);
  canvas.Rect(0.5 * thickness, 0.5 * h, thickness, h, color);
  canvas.Rect(w - 0.5 * thickness, 0.5 * h, thickness, h, color);
}

}  // namespace rds::synthetic
