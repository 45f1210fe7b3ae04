// SPDX-License-Identifier: Apache-2.0
#include "synth/canvas.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rds::synthetic {
namespace {

TEST(Canvas, ShapesCoverTheirArea) {
  Canvas canvas(1.0, 0.5, 0.005);
  canvas.Fill({0, 0, 0});
  canvas.Rect(0.5, 0.25, 0.3, 0.1, {100, 0, 0}, 0.4);
  canvas.Disc(0.15, 0.25, 0.1, {0, 100, 0});
  double rect = 0;
  double disc = 0;
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      rect += static_cast<double>(canvas.At(x, y).b) / 100 * 0.005 * 0.005;
      disc += static_cast<double>(canvas.At(x, y).g) / 100 * 0.005 * 0.005;
    }
  }
  EXPECT_NEAR(rect, 0.03, 3e-4);
  EXPECT_NEAR(disc, M_PI * 0.01, 3e-4);
}

TEST(Canvas, ShapesMayReachOverTheBorder) {
  Canvas canvas(0.2, 0.2, 0.01);
  canvas.Fill({1, 1, 1});
  canvas.Rect(-0.1, 0.1, 5, 5, {9, 9, 9}, 0.3);
  canvas.Line(-3, -3, 4, 4, 0.01, {7, 7, 7});
  EXPECT_FLOAT_EQ(canvas.At(0, 19).g, 9);
}

TEST(Canvas, NoiseKeepsTheMeanAndIsSeeded) {
  Canvas a(2, 2, 0.01);
  Canvas b(2, 2, 0.01);
  Canvas c(2, 2, 0.01);
  for (Canvas* canvas : {&a, &b, &c}) {
    canvas->Fill({100, 100, 100});
    canvas->Noise(canvas == &c ? 4 : 3, 0.2, 0.2, 5, 0.3);
  }
  double mean = 0;
  double square = 0;
  int same = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      const double value = static_cast<double>(a.At(x, y).r);
      ASSERT_EQ(a.At(x, y).r, b.At(x, y).r);
      same += a.At(x, y).r == c.At(x, y).r ? 1 : 0;
      mean += value / (a.width() * a.height());
      square += value * value / (a.width() * a.height());
    }
  }
  EXPECT_LT(same, 100);
  EXPECT_NEAR(mean, 100, 2.5);
  EXPECT_GT(std::sqrt(square - mean * mean), 4);
  EXPECT_LT(std::sqrt(square - mean * mean), 15);
}

TEST(Color, HsvGivesThePrimaries) {
  EXPECT_FLOAT_EQ(FromHsv(0, 1, 1).r, 255);
  EXPECT_FLOAT_EQ(FromHsv(0, 1, 1).g, 0);
  EXPECT_NEAR(FromHsv(1.0 / 3, 1, 1).g, 255, 1e-3);
  EXPECT_NEAR(FromHsv(2.0 / 3, 1, 1).b, 255, 1e-3);
  EXPECT_NEAR(FromHsv(2.0 / 3, 1, 1).r, 0, 1e-3);
}

}  // namespace
}  // namespace rds::synthetic
