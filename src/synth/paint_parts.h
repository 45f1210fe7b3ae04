// SPDX-License-Identifier: Apache-2.0
// Parts that several recipes of paint.h share.
#pragma once

#include "synth/paint.h"

namespace rds::synthetic {

inline constexpr Color kWhite{238, 240, 242};
inline constexpr Color kBlack{26, 24, 24};

// Lines of "text" in a box with the upper left corner (x, y): words as dark bars of uneven length, ragged on the right.
void PaintText(Canvas& canvas, Random& random, double x, double y, double width, double height, double line,
               const Color& ink);
// Discs and turned rectangles of all sizes, the large ones first.
void PaintShapes(Canvas& canvas, Random& random, int count, double largest);
void PaintBorder(Canvas& canvas, double thickness, const Color& color);

}  // namespace rds::synthetic
