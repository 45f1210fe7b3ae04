// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "synth/paint.h"
#include "synth/paint_parts.h"

namespace rds::synthetic {

void PaintPlaster(Canvas& canvas, Random& random, const Color& base) {
  canvas.Fill(base);
  canvas.Noise(random.Bits(), 0.6, 0.6, 7, 0.16);
  const int marks = static_cast<int>(canvas.width_m() * canvas.height_m() * 14);
  for (int i = 0; i < marks; ++i) {  // chips, dowels, stains
    const float shade = static_cast<float>(random.Uniform(0.45, 1.25));
    const double x = random.Uniform(0, canvas.width_m());
    const double y = random.Uniform(0, canvas.height_m());
    const double size = random.Uniform(0.012, 0.05);
    if (random.Index(2) == 0) {
      canvas.Disc(x, y, 0.5 * size, shade * base, 0.7F);
    } else {
      canvas.Rect(x, y, size, size * random.Uniform(0.3, 1), shade * base, random.Uniform(0, 3), 0.7F);
    }
  }
}

void PaintWallpaper(Canvas& canvas, Random& random, const Color& base) {
  canvas.Fill(base);
  const int count = static_cast<int>(canvas.width_m() * canvas.height_m() * 42);
  for (int i = 0; i < count; ++i) {
    const double x = random.Uniform(0, canvas.width_m());
    const double y = random.Uniform(0, canvas.height_m());
    const double size = random.Uniform(0.03, 0.14);
    const Color color =
        Mix(base, RandomColor(random, 0.15, 0.6, 0.25, 1.0), static_cast<float>(random.Uniform(0.35, 0.8)));
    switch (random.Index(3)) {
      case 0:  // leaf with a vein
      {
        const double angle = random.Uniform(0, std::numbers::pi);
        canvas.Rect(x, y, size, 0.38 * size, color, angle);
        canvas.Rect(x, y, 1.3 * size, 0.06 * size, 0.6F * color, angle);
        break;
      }
      case 1:  // ring
        canvas.Disc(x, y, 0.5 * size, color);
        canvas.Disc(x, y, 0.3 * size, base);
        break;
      default:
        canvas.Rect(x, y, size, 0.2 * size, color, random.Uniform(0, std::numbers::pi));
    }
  }
  canvas.Noise(random.Bits(), 0.5, 0.5, 7, 0.13);
}

void PaintPlanks(Canvas& canvas, Random& random, const Color& base, double plank_width, double plank_length) {
  canvas.Fill(base);
  for (double y = 0; y < canvas.height_m(); y += plank_width) {
    double x = -random.Uniform(0, plank_length);
    while (x < canvas.width_m()) {
      const double length = plank_length * random.Uniform(0.6, 1.2);
      const Color tone = static_cast<float>(random.Uniform(0.68, 1.2)) *
                         Mix(base, Color{70, 110, 170}, static_cast<float>(random.Uniform(0, 0.35)));
      canvas.Rect(x + 0.5 * length, y + 0.5 * plank_width, length - 0.004, plank_width - 0.004, tone);
      for (int knot = 0; knot < 3; ++knot) {
        const double at = x + random.Uniform(0.05, 0.95) * length;
        const double across = y + random.Uniform(0.2, 0.8) * plank_width;
        canvas.Disc(at, across, random.Uniform(0.006, 0.016), 0.5F * tone);
      }
      x += length;
    }
    canvas.Rect(0.5 * canvas.width_m(), y, canvas.width_m(), 0.006, 0.4F * base);
  }
  canvas.Noise(random.Bits(), 0.5, 0.06, 5, 0.26);
  canvas.Noise(random.Bits(), 0.8, 0.8, 6, 0.12);
}

void PaintWood(Canvas& canvas, Random& random, const Color& base) {
  canvas.Fill(base);
  canvas.Noise(random.Bits(), 0.7, 0.05, 5, 0.3);
  canvas.Noise(random.Bits(), 0.2, 0.2, 5, 0.14);
  const int knots = static_cast<int>(canvas.width_m() * canvas.height_m() * 30);
  for (int i = 0; i < knots; ++i) {
    const double x = random.Uniform(0, canvas.width_m());
    const double y = random.Uniform(0, canvas.height_m());
    const double radius = random.Uniform(0.006, 0.018);
    canvas.Disc(x, y, radius, 0.5F * base);
    canvas.Disc(x, y, 0.5 * radius, 0.3F * base);
  }
}

void PaintTiles(Canvas& canvas, Random& random, const Color& base, double tile) {
  canvas.Fill(0.55F * base);
  for (double y = 0; y < canvas.height_m(); y += tile) {
    for (double x = 0; x < canvas.width_m(); x += tile) {
      const Color tone = random.Index(4) == 0 ? RandomColor(random, 0.2, 0.7, 0.35, 0.9)
                                              : static_cast<float>(random.Uniform(0.75, 1.15)) * base;
      canvas.Rect(x + 0.5 * tile, y + 0.5 * tile, 0.95 * tile, 0.95 * tile, tone);
    }
  }
  canvas.Noise(random.Bits(), 0.3, 0.3, 6, 0.12);
}

void PaintRug(Canvas& canvas, Random& random) {
  const Color ground = FromHsv(random.Uniform(0.95, 1.08), 0.6, 0.45);
  canvas.Fill(ground);
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  PaintShapes(canvas, random, 90, 0.5);
  for (int i = 0; i < 4; ++i) {
    const double inset = 0.06 * i;
    const Color color = i % 2 == 0 ? ground : RandomColor(random, 0.3, 0.7, 0.4, 0.8);
    for (const double side : {inset, w - inset}) {
      canvas.Rect(side, 0.5 * h, 0.05, h - 2 * inset, color);
    }
    for (const double side : {inset, h - inset}) {
      canvas.Rect(0.5 * w, side, w - 2 * inset, 0.05, color);
    }
  }
  canvas.Noise(random.Bits(), 0.04, 0.04, 3, 0.18);
  canvas.Noise(random.Bits(), 0.7, 0.7, 4, 0.15);
}

void PaintWindow(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Gradient({250, 225, 190}, {245, 240, 228});
  for (int row = 0; row < 3; ++row) {  // houses, the farther ones first
    double x = -0.1;
    while (x < w) {
      const double width = random.Uniform(0.15, 0.4);
      const double top = h * random.Uniform(0.25 + 0.18 * row, 0.42 + 0.18 * row);
      const Color wall = FromHsv(random.Uniform(-0.03, 0.14), random.Uniform(0.1, 0.5), random.Uniform(0.45, 0.9));
      canvas.Rect(x + 0.5 * width, 0.5 * (top + h), width, h - top, wall);
      for (double wy = top + 0.04; wy < h; wy += 0.065) {
        for (double wx = x + 0.03; wx < x + width - 0.02; wx += 0.055) {
          if (random.Index(4) != 0) {
            canvas.Rect(wx, wy, 0.026, 0.034, static_cast<float>(random.Uniform(0.3, 0.6)) * wall);
          }
        }
      }
      x += width * random.Uniform(0.9, 1.3);
    }
  }
  for (int i = 1; i < 3; ++i) {
    canvas.Rect(w * i / 3, 0.5 * h, 0.04, h, kWhite);
  }
  canvas.Rect(0.5 * w, 0.35 * h, w, 0.03, kWhite);
  PaintBorder(canvas, 0.06, kWhite);
}

void PaintCeiling(Canvas& canvas, Random& random) {
  const Color base{226, 230, 232};
  canvas.Fill(base);
  const double tile = 0.6;
  for (double y = 0; y < canvas.height_m(); y += tile) {
    for (double x = 0; x < canvas.width_m(); x += tile) {
      canvas.Rect(x + 0.5 * tile, y + 0.5 * tile, tile - 0.015, tile - 0.015,
                  static_cast<float>(random.Uniform(0.82, 1.04)) * base);
      for (int i = 0; i < 14; ++i) {
        canvas.Disc(x + random.Uniform(0.05, 0.55), y + random.Uniform(0.05, 0.55), random.Uniform(0.008, 0.022),
                    static_cast<float>(random.Uniform(0.5, 0.8)) * base);
      }
    }
    canvas.Rect(0.5 * canvas.width_m(), y, canvas.width_m(), 0.014, 0.6F * base);
  }
  for (double x = 0; x < canvas.width_m(); x += tile) {
    canvas.Rect(x, 0.5 * canvas.height_m(), 0.014, canvas.height_m(), 0.6F * base);
  }
  canvas.Noise(random.Bits(), 0.7, 0.7, 5, 0.08);
}

}  // namespace rds::synthetic
