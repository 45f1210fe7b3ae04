// SPDX-License-Identifier: Apache-2.0
// Draws a scene as a pinhole camera sees it: exact visibility, filtered colors.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "synth/scene.h"

namespace rds::synthetic {

// A drawn frame. Depth belongs to the ray through the pixel's center; color is the mean of 2 x 2 samples of the pixel.
struct Drawing {
  std::vector<float> color;    // blue, green, red for each pixel, 0 to 255
  std::vector<float> depth_m;  // 0 where nothing is seen
  Image8 mask;                 // 255 where the center ray or any of the four samples sees a mover
};

// Surfaces nearer than a few centimeters are drawn as they are; there is no near plane. Deterministic. Thread-safe: no
// state.
Drawing Draw(const Scene& scene, const PinholeCamera& camera, const Rigid3& camera_from_world);

}  // namespace rds::synthetic
