// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/paint.h"
#include "synth/paint_parts.h"

namespace rds::synthetic {

void PaintPoster(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Gradient(RandomColor(random, 0.1, 0.7, 0.4, 0.95), RandomColor(random, 0.1, 0.7, 0.2, 0.8));
  PaintShapes(canvas, random, 22 + static_cast<int>(random.Index(20)), 0.5 * std::min(w, h));
  if (random.Index(2) == 0) {  // a block of text
    const double top = random.Uniform(0.5, 0.7) * h;
    canvas.Rect(0.5 * w, 0.5 * (top + 0.94 * h), 0.88 * w, 0.94 * h - top, kWhite);
    PaintText(canvas, random, 0.1 * w, top + 0.02 * h, 0.8 * w, 0.9 * h - top, random.Uniform(0.022, 0.04), kBlack);
  }
  canvas.Noise(random.Bits(), 0.2, 0.2, 5, 0.12);
  PaintBorder(canvas, 0.02, random.Index(2) == 0 ? kBlack : kWhite);
}

void PaintWhiteboard(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Fill(kWhite);
  for (int i = 0; i < 26; ++i) {
    const Color ink = FromHsv(random.Index(3) / 3.0, 0.8, random.Uniform(0.2, 0.6));
    const double x = random.Uniform(0.06, 0.85) * w;
    const double y = random.Uniform(0.06, 0.85) * h;
    switch (random.Index(4)) {
      case 0:
        PaintText(canvas, random, x, y, 0.3, random.Uniform(0.05, 0.15), 0.035, ink);
        break;
      case 1: {
        const double size = random.Uniform(0.08, 0.2);
        canvas.Rect(x, y, size, 0.6 * size, ink);
        canvas.Rect(x, y, size - 0.02, 0.6 * size - 0.02, kWhite);
        break;
      }
      case 2:
        canvas.Disc(x, y, 0.06, ink);
        canvas.Disc(x, y, 0.048, kWhite);
        break;
      default:
        for (int k = 0; k < 5; ++k) {
          canvas.Line(x, y, x + random.Uniform(-0.2, 0.2), y + random.Uniform(-0.15, 0.15), 0.009, ink);
        }
    }
  }
  canvas.Noise(random.Bits(), 0.5, 0.5, 5, 0.07);
  PaintBorder(canvas, 0.03, {120, 120, 122});
}

void PaintScreen(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Gradient({150, 90, 30}, {90, 40, 70});
  for (int i = 0; i < 3; ++i) {
    const double width = w * random.Uniform(0.35, 0.6);
    const double height = h * random.Uniform(0.4, 0.7);
    const double x = random.Uniform(0.03 * w, 0.95 * w - width);
    const double y = random.Uniform(0.03 * h, 0.95 * h - height);
    const bool dark = random.Index(2) == 0;
    canvas.Rect(x + 0.5 * width, y + 0.5 * height, width, height, dark ? Color{40, 34, 30} : kWhite);
    canvas.Rect(x + 0.5 * width, y + 0.012, width, 0.024, RandomColor(random, 0.2, 0.6, 0.5, 0.9));
    PaintText(canvas, random, x + 0.02, y + 0.035, width - 0.04, height - 0.05, 0.02,
              dark ? Color{120, 220, 140} : kBlack);
  }
  PaintBorder(canvas, 0.018, kBlack);
}

void PaintKeyboard(Canvas& canvas, Random& random) {
  canvas.Fill({52, 50, 50});
  for (double y = 0.022; y < canvas.height_m() - 0.01; y += 0.024) {
    double x = 0.015;
    while (x < canvas.width_m() - 0.02) {
      const double key = random.Index(6) == 0 ? 0.045 : 0.02;
      canvas.Rect(x + 0.5 * key, y, key - 0.003, 0.02, static_cast<float>(random.Uniform(0.6, 1.0)) * kWhite);
      x += key;
    }
  }
}

void PaintBookshelf(Canvas& canvas, Random& random, const Color& wood, double shelf_height) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Fill(0.28F * wood);
  const int shelves = std::max(1, static_cast<int>(std::lround(h / shelf_height)));
  const double pitch = h / shelves;
  for (int shelf = 0; shelf < shelves; ++shelf) {
    const double floor_y = (shelf + 1) * pitch - 0.02;
    double x = 0.03;
    while (x < w - 0.06) {
      if (random.Index(14) == 0) {  // a gap, sometimes with a thing in it
        const double gap = random.Uniform(0.05, 0.12);
        if (random.Index(2) == 0) {
          canvas.Disc(x + 0.5 * gap, floor_y - 0.4 * gap, 0.4 * gap, RandomColor(random, 0.2, 0.8, 0.4, 0.9));
        }
        x += gap;
        continue;
      }
      const double width = std::min(random.Uniform(0.018, 0.055), w - 0.03 - x);
      const double height = (pitch - 0.03) * random.Uniform(0.6, 0.95);
      const Color cover = RandomColor(random, 0.1, 0.8, 0.2, 0.9);
      const double lean = random.Index(9) == 0 ? random.Uniform(-0.08, 0.08) : 0;
      canvas.Rect(x + 0.5 * width, floor_y - 0.5 * height, width - 0.003, height, cover, lean);
      const Color title = RandomColor(random, 0.0, 0.4, 0.7, 1.0);
      const double band = random.Uniform(0.2, 0.8) * height;
      canvas.Rect(x + 0.5 * width, floor_y - band, 0.6 * width, random.Uniform(0.02, 0.07), title, lean);
      canvas.Rect(x + 0.5 * width, floor_y - 0.06 * height, width - 0.003, 0.008, 0.5F * title, lean);
      x += width;
    }
    canvas.Rect(0.5 * w, floor_y + 0.01, w, 0.022, wood);
  }
  canvas.Rect(0.5 * w, 0.012, w, 0.024, wood);
  canvas.Rect(0.012, 0.5 * h, 0.024, h, wood);
  canvas.Rect(w - 0.012, 0.5 * h, 0.024, h, wood);
  canvas.Noise(random.Bits(), 0.2, 0.2, 5, 0.14);
}

void PaintCabinet(Canvas& canvas, Random& random, const Color& base, int columns, int rows) {
  PaintWood(canvas, random, base);
  const double w = canvas.width_m() / columns;
  const double h = canvas.height_m() / rows;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = (column + 0.5) * w;
      const double y = (row + 0.5) * h;
      for (const double side : {-0.5, 0.5}) {
        canvas.Rect(x + side * w, y, 0.008, h, 0.25F * base);
        canvas.Rect(x, y + side * h, w, 0.008, 0.25F * base);
        canvas.Rect(x + 0.84 * side * w, y, 0.006, 0.8 * h, 0.6F * base);
        canvas.Rect(x, y + 0.8 * side * h, 0.84 * w, 0.006, 0.6F * base);
      }
      canvas.Rect(x, y - 0.25 * h, 0.12, 0.022, {190, 195, 200});
      canvas.Rect(x, y - 0.25 * h + 0.016, 0.12, 0.01, 0.3F * base);
      const std::uint32_t stickers = 1 + random.Index(4);
      for (std::uint32_t i = 0; i < stickers; ++i) {
        const double size = random.Uniform(0.05, 0.12);
        const double right = x + random.Uniform(-0.3, 0.3) * w;
        const double down = y + random.Uniform(-0.15, 0.35) * h;
        const double angle = random.Uniform(-0.4, 0.4);
        canvas.Rect(right, down, size, 0.7 * size, RandomColor(random, 0.2, 0.8, 0.4, 1.0), angle);
        canvas.Rect(right, down, 0.5 * size, 0.3 * size, RandomColor(random, 0.0, 0.6, 0.1, 0.9), angle);
      }
    }
  }
}

void PaintCarton(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Fill({90, 135, 175});
  canvas.Rect(0.5 * w, 0.5 * h, w, 0.05, {130, 175, 205});
  for (int i = 0; i < 3; ++i) {
    const double x = random.Uniform(0.2, 0.8) * w;
    const double y = random.Uniform(0.2, 0.8) * h;
    const double size = random.Uniform(0.06, 0.14);
    canvas.Rect(x, y, size, 0.7 * size, kWhite, random.Uniform(-0.2, 0.2));
    PaintText(canvas, random, x - 0.4 * size, y - 0.3 * size, 0.75 * size, 0.55 * size, 0.016, kBlack);
    canvas.Rect(random.Uniform(0.1, 0.9) * w, random.Uniform(0.1, 0.9) * h, 0.07, 0.03,
                RandomColor(random, 0.4, 0.9, 0.2, 0.8), random.Uniform(0, 3));
  }
  canvas.Noise(random.Bits(), 0.15, 0.15, 6, 0.2);
  PaintBorder(canvas, 0.006, {50, 80, 110});
}

void PaintPaperwork(Canvas& canvas, Random& random, const Color& wood) {
  PaintWood(canvas, random, wood);
  const int sheets = static_cast<int>(canvas.width_m() * canvas.height_m() * 11) + 2;
  for (int i = 0; i < sheets; ++i) {
    const double x = random.Uniform(0.05, canvas.width_m() - 0.05);
    const double y = random.Uniform(0.05, canvas.height_m() - 0.05);
    const double angle = random.Uniform(-0.5, 0.5);
    const bool note = random.Index(3) == 0;
    const double width = note ? 0.08 : 0.21;
    const double height = note ? 0.08 : 0.29;
    canvas.Rect(x, y, width + 0.006, height + 0.006, 0.4F * wood, angle);
    canvas.Rect(x, y, width, height, note ? RandomColor(random, 0.4, 0.7, 0.8, 1.0) : kWhite, angle);
    for (int line = 0; line < (note ? 3 : 9); ++line) {
      const double down = (line + 1.0) / (note ? 4 : 10) * height - 0.5 * height;
      const double length = width * random.Uniform(0.4, 0.8);
      const double left = 0.5 * (length - 0.8 * width);
      canvas.Rect(x + std::cos(angle) * left - std::sin(angle) * down,
                  y + std::sin(angle) * left + std::cos(angle) * down, length, 0.008, kBlack, angle, 0.8F);
    }
  }
}

void PaintFabric(Canvas& canvas, Random& random, const Color& base) {
  canvas.Fill(base);
  const int count = 6 + static_cast<int>(canvas.width_m() * canvas.height_m() * 60);
  for (int i = 0; i < count; ++i) {
    canvas.Rect(random.Uniform(0, canvas.width_m()), random.Uniform(0, canvas.height_m()), random.Uniform(0.02, 0.12),
                random.Uniform(0.01, 0.05), Mix(base, RandomColor(random, 0.2, 0.6, 0.2, 1.0), 0.6F),
                random.Uniform(0, std::numbers::pi));
  }
  canvas.Noise(random.Bits(), 0.1, 0.1, 4, 0.22);
}

}  // namespace rds::synthetic
