#include "testing/paint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rds::synthetic {
namespace {

constexpr Colour kWhite{238, 240, 242};
constexpr Colour kBlack{26, 24, 24};

// Lines of "text": words as dark bars of uneven length with a ragged right border.
void PaintText(Canvas& canvas, Random& random, double x, double y, double width, double height, double line,
               const Colour& ink) {
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

// Shapes of all sizes, the large ones first.
void PaintShapes(Canvas& canvas, Random& random, int count, double largest) {
  for (int i = 0; i < count; ++i) {
    const double size = largest * std::pow(0.12, static_cast<double>(i) / count) * random.Uniform(0.6, 1.0);
    const double x = random.Uniform(0, canvas.width_m());
    const double y = random.Uniform(0, canvas.height_m());
    const Colour colour = RandomColour(random, 0.2, 0.8, 0.15, 0.95);
    if (random.Index(3) == 0) {
      canvas.Disc(x, y, 0.5 * size, colour);
      if (random.Index(2) == 0) {
        canvas.Disc(x, y, 0.28 * size, RandomColour(random, 0.1, 0.7, 0.15, 0.95));
      }
    } else {
      canvas.Rect(x, y, size, size * random.Uniform(0.25, 1.0), colour, random.Uniform(0, std::numbers::pi));
    }
  }
}

void PaintBorder(Canvas& canvas, double thickness, const Colour& colour) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Rect(0.5 * w, 0.5 * thickness, w, thickness, colour);
  canvas.Rect(0.5 * w, h - 0.5 * thickness, w, thickness, colour);
  canvas.Rect(0.5 * thickness, 0.5 * h, thickness, h, colour);
  canvas.Rect(w - 0.5 * thickness, 0.5 * h, thickness, h, colour);
}

}  // namespace

void PaintPlaster(Canvas& canvas, Random& random, const Colour& base) {
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

void PaintWallpaper(Canvas& canvas, Random& random, const Colour& base) {
  canvas.Fill(base);
  const int count = static_cast<int>(canvas.width_m() * canvas.height_m() * 42);
  for (int i = 0; i < count; ++i) {
    const double x = random.Uniform(0, canvas.width_m());
    const double y = random.Uniform(0, canvas.height_m());
    const double size = random.Uniform(0.03, 0.14);
    const Colour colour =
        Mix(base, RandomColour(random, 0.15, 0.6, 0.25, 1.0), static_cast<float>(random.Uniform(0.35, 0.8)));
    switch (random.Index(3)) {
      case 0:  // leaf with a vein
      {
        const double angle = random.Uniform(0, std::numbers::pi);
        canvas.Rect(x, y, size, 0.38 * size, colour, angle);
        canvas.Rect(x, y, 1.3 * size, 0.06 * size, 0.6F * colour, angle);
        break;
      }
      case 1:  // ring
        canvas.Disc(x, y, 0.5 * size, colour);
        canvas.Disc(x, y, 0.3 * size, base);
        break;
      default:
        canvas.Rect(x, y, size, 0.2 * size, colour, random.Uniform(0, std::numbers::pi));
    }
  }
  canvas.Noise(random.Bits(), 0.5, 0.5, 7, 0.13);
}

void PaintPlanks(Canvas& canvas, Random& random, const Colour& base, double plank_width, double plank_length) {
  canvas.Fill(base);
  for (double y = 0; y < canvas.height_m(); y += plank_width) {
    double x = -random.Uniform(0, plank_length);
    while (x < canvas.width_m()) {
      const double length = plank_length * random.Uniform(0.6, 1.2);
      const Colour tone = static_cast<float>(random.Uniform(0.68, 1.2)) *
                          Mix(base, Colour{70, 110, 170}, static_cast<float>(random.Uniform(0, 0.35)));
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

void PaintWood(Canvas& canvas, Random& random, const Colour& base) {
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

void PaintTiles(Canvas& canvas, Random& random, const Colour& base, double tile) {
  canvas.Fill(0.55F * base);
  for (double y = 0; y < canvas.height_m(); y += tile) {
    for (double x = 0; x < canvas.width_m(); x += tile) {
      const Colour tone = random.Index(4) == 0 ? RandomColour(random, 0.2, 0.7, 0.35, 0.9)
                                               : static_cast<float>(random.Uniform(0.75, 1.15)) * base;
      canvas.Rect(x + 0.5 * tile, y + 0.5 * tile, 0.95 * tile, 0.95 * tile, tone);
    }
  }
  canvas.Noise(random.Bits(), 0.3, 0.3, 6, 0.12);
}

void PaintRug(Canvas& canvas, Random& random) {
  const Colour ground = FromHsv(random.Uniform(0.95, 1.08), 0.6, 0.45);
  canvas.Fill(ground);
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  PaintShapes(canvas, random, 90, 0.5);
  for (int i = 0; i < 4; ++i) {
    const double inset = 0.06 * i;
    const Colour colour = i % 2 == 0 ? ground : RandomColour(random, 0.3, 0.7, 0.4, 0.8);
    for (const double side : {inset, w - inset}) {
      canvas.Rect(side, 0.5 * h, 0.05, h - 2 * inset, colour);
    }
    for (const double side : {inset, h - inset}) {
      canvas.Rect(0.5 * w, side, w - 2 * inset, 0.05, colour);
    }
  }
  canvas.Noise(random.Bits(), 0.04, 0.04, 3, 0.18);
  canvas.Noise(random.Bits(), 0.7, 0.7, 4, 0.15);
}

void PaintPoster(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Gradient(RandomColour(random, 0.1, 0.7, 0.4, 0.95), RandomColour(random, 0.1, 0.7, 0.2, 0.8));
  PaintShapes(canvas, random, 22 + static_cast<int>(random.Index(20)), 0.5 * std::min(w, h));
  if (random.Index(2) == 0) {  // a block of text
    const double top = random.Uniform(0.5, 0.7) * h;
    canvas.Rect(0.5 * w, 0.5 * (top + 0.94 * h), 0.88 * w, 0.94 * h - top, kWhite);
    PaintText(canvas, random, 0.1 * w, top + 0.02 * h, 0.8 * w, 0.9 * h - top, random.Uniform(0.022, 0.04), kBlack);
  }
  canvas.Noise(random.Bits(), 0.2, 0.2, 5, 0.12);
  PaintBorder(canvas, 0.02, random.Index(2) == 0 ? kBlack : kWhite);
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
      const Colour wall = FromHsv(random.Uniform(-0.03, 0.14), random.Uniform(0.1, 0.5), random.Uniform(0.45, 0.9));
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

void PaintWhiteboard(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.Fill(kWhite);
  for (int i = 0; i < 26; ++i) {
    const Colour ink = FromHsv(random.Index(3) / 3.0, 0.8, random.Uniform(0.2, 0.6));
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
    canvas.Rect(x + 0.5 * width, y + 0.5 * height, width, height, dark ? Colour{40, 34, 30} : kWhite);
    canvas.Rect(x + 0.5 * width, y + 0.012, width, 0.024, RandomColour(random, 0.2, 0.6, 0.5, 0.9));
    PaintText(canvas, random, x + 0.02, y + 0.035, width - 0.04, height - 0.05, 0.02,
              dark ? Colour{120, 220, 140} : kBlack);
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

void PaintBookshelf(Canvas& canvas, Random& random, const Colour& wood, double shelf_height) {
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
          canvas.Disc(x + 0.5 * gap, floor_y - 0.4 * gap, 0.4 * gap, RandomColour(random, 0.2, 0.8, 0.4, 0.9));
        }
        x += gap;
        continue;
      }
      const double width = std::min(random.Uniform(0.018, 0.055), w - 0.03 - x);
      const double height = (pitch - 0.03) * random.Uniform(0.6, 0.95);
      const Colour cover = RandomColour(random, 0.1, 0.8, 0.2, 0.9);
      const double lean = random.Index(9) == 0 ? random.Uniform(-0.08, 0.08) : 0;
      canvas.Rect(x + 0.5 * width, floor_y - 0.5 * height, width - 0.003, height, cover, lean);
      const Colour title = RandomColour(random, 0.0, 0.4, 0.7, 1.0);
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

void PaintCabinet(Canvas& canvas, Random& random, const Colour& base, int columns, int rows) {
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
      if (random.Index(2) == 0) {  // a sticker
        canvas.Rect(x + random.Uniform(-0.25, 0.25) * w, y + random.Uniform(-0.1, 0.3) * h, 0.09, 0.06,
                    RandomColour(random, 0.3, 0.8, 0.5, 1.0), random.Uniform(-0.3, 0.3));
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
                RandomColour(random, 0.4, 0.9, 0.2, 0.8), random.Uniform(0, 3));
  }
  canvas.Noise(random.Bits(), 0.15, 0.15, 6, 0.2);
  PaintBorder(canvas, 0.006, {50, 80, 110});
}

void PaintPaperwork(Canvas& canvas, Random& random, const Colour& wood) {
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
    canvas.Rect(x, y, width, height, note ? RandomColour(random, 0.4, 0.7, 0.8, 1.0) : kWhite, angle);
    for (int line = 0; line < (note ? 3 : 9); ++line) {
      const double down = (line + 1.0) / (note ? 4 : 10) * height - 0.5 * height;
      const double length = width * random.Uniform(0.4, 0.8);
      const double left = 0.5 * (length - 0.8 * width);
      canvas.Rect(x + std::cos(angle) * left - std::sin(angle) * down,
                  y + std::sin(angle) * left + std::cos(angle) * down, length, 0.008, kBlack, angle, 0.8F);
    }
  }
}

void PaintFabric(Canvas& canvas, Random& random, const Colour& base) {
  canvas.Fill(base);
  const int count = 6 + static_cast<int>(canvas.width_m() * canvas.height_m() * 60);
  for (int i = 0; i < count; ++i) {
    canvas.Rect(random.Uniform(0, canvas.width_m()), random.Uniform(0, canvas.height_m()), random.Uniform(0.02, 0.12),
                random.Uniform(0.01, 0.05), Mix(base, RandomColour(random, 0.2, 0.6, 0.2, 1.0), 0.6F),
                random.Uniform(0, std::numbers::pi));
  }
  canvas.Noise(random.Bits(), 0.1, 0.1, 4, 0.22);
}

void PaintCeiling(Canvas& canvas, Random& random) {
  const Colour base{226, 230, 232};
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

void PaintShirt(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  const Colour base = RandomColour(random, 0.4, 0.85, 0.35, 0.9);
  const Colour other = RandomColour(random, 0.1, 0.8, 0.2, 1.0);
  canvas.Fill(base);
  switch (random.Index(3)) {
    case 0:
      for (double y = 0; y < h; y += 0.07) {
        canvas.Rect(0.5 * w, y, w, 0.028, other);
      }
      break;
    case 1:
      for (double x = 0; x < w; x += w / 12) {
        canvas.Rect(x, 0.5 * h, 0.03, h, other, 0, 0.6F);
      }
      for (double y = 0; y < h; y += 0.08) {
        canvas.Rect(0.5 * w, y, w, 0.03, other, 0, 0.6F);
      }
      break;
    default:
      for (int i = 0; i < 26; ++i) {
        canvas.Rect(random.Uniform(0, w), random.Uniform(0, h), random.Uniform(0.02, 0.1), random.Uniform(0.02, 0.06),
                    RandomColour(random, 0.2, 0.9, 0.3, 1.0), random.Uniform(0, 3));
      }
  }
  // The chest is at half the width: a print on it.
  canvas.Rect(0.5 * w, 0.35 * h, 0.16, 0.12, kWhite);
  PaintText(canvas, random, 0.5 * w - 0.07, 0.35 * h - 0.05, 0.14, 0.1, 0.025, kBlack);
  canvas.Noise(random.Bits(), 0.12, 0.12, 4, 0.2);
}

void PaintDenim(Canvas& canvas, Random& random) {
  const Colour base = Mix({120, 70, 45}, RandomColour(random, 0.2, 0.5, 0.2, 0.6), 0.35F);
  canvas.Fill(base);
  for (int i = 0; i < 8; ++i) {  // creases and patches
    canvas.Rect(random.Uniform(0, canvas.width_m()), random.Uniform(0, canvas.height_m()), random.Uniform(0.05, 0.12),
                random.Uniform(0.008, 0.04), static_cast<float>(random.Uniform(0.6, 1.5)) * base,
                random.Uniform(-0.4, 0.4));
  }
  canvas.Noise(random.Bits(), 0.06, 0.12, 5, 0.4);
}

void PaintSkin(Canvas& canvas, Random& random, const Colour& skin) {
  canvas.Fill(skin);
  canvas.Noise(random.Bits(), 0.05, 0.05, 3, 0.1);
}

void PaintFace(Canvas& canvas, Random& random, const Colour& skin) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  PaintSkin(canvas, random, skin);
  for (const double side : {-1.0, 1.0}) {
    canvas.Disc(0.5 * w + 0.034 * side, 0.46 * h, 0.013, kWhite);
    canvas.Disc(0.5 * w + 0.034 * side, 0.46 * h, 0.007, kBlack);
    canvas.Rect(0.5 * w + 0.034 * side, 0.38 * h, 0.035, 0.008, 0.35F * skin);
  }
  canvas.Rect(0.5 * w, 0.54 * h, 0.018, 0.045, 0.82F * skin);
  canvas.Rect(0.5 * w, 0.68 * h, 0.05, 0.012, {90, 80, 170});
}

}  // namespace rds::synthetic
