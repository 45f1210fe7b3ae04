// SPDX-License-Identifier: Apache-2.0
#include "synth/paint.h"
#include "synth/paint_parts.h"

namespace rds::synthetic {

void PaintShirt(Canvas& canvas, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  const Color base = RandomColor(random, 0.4, 0.85, 0.35, 0.9);
  const Color other = RandomColor(random, 0.1, 0.8, 0.2, 1.0);
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
                    RandomColor(random, 0.2, 0.9, 0.3, 1.0), random.Uniform(0, 3));
      }
  }
  if (w > 0.6) {  // not a sleeve; the chest is at half the width: a print on it
    canvas.Rect(0.5 * w, 0.35 * h, 0.16, 0.12, kWhite);
    PaintText(canvas, random, 0.5 * w - 0.07, 0.35 * h - 0.05, 0.14, 0.1, 0.025, kBlack);
  }
  canvas.Noise(random.Bits(), 0.12, 0.12, 4, 0.2);
}

void PaintDenim(Canvas& canvas, Random& random) {
  const Color base = Mix({120, 70, 45}, RandomColor(random, 0.2, 0.5, 0.2, 0.6), 0.35F);
  canvas.Fill(base);
  for (int i = 0; i < 8; ++i) {  // creases and patches
    canvas.Rect(random.Uniform(0, canvas.width_m()), random.Uniform(0, canvas.height_m()), random.Uniform(0.05, 0.12),
                random.Uniform(0.008, 0.04), static_cast<float>(random.Uniform(0.6, 1.5)) * base,
                random.Uniform(-0.4, 0.4));
  }
  canvas.Noise(random.Bits(), 0.06, 0.12, 5, 0.4);
}

void PaintSkin(Canvas& canvas, Random& random, const Color& skin) {
  canvas.Fill(skin);
  canvas.Noise(random.Bits(), 0.05, 0.05, 3, 0.1);
}

void PaintFace(Canvas& canvas, Random& random, const Color& skin) {
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
