// SPDX-License-Identifier: Apache-2.0
// Masks made whole with the help of depth.
#pragma once

#include "base/image.h"
#include "feature/frame_data.h"

namespace rds {

// Makes unsure pixels dynamic where they lie on one surface with dynamic ones: reached from those over unsure samples
// of the depth grid without a jump in depth (neighbors differ by at most the share `depth_step_ratio`). A network that
// is sure of a shirt's middle only gets the whole shirt so, and nothing of the wall behind it: hysteresis thresholding
// (Canny, "A computational approach to edge detection", PAMI 1986) along surfaces. The mask has the size of the
// recorded image; without a grid it stays as it is.
void CompleteMask(const DepthGrid& grid, double depth_step_ratio, Image8& mask);

}  // namespace rds
