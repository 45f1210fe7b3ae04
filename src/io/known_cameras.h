// SPDX-License-Identifier: Apache-2.0
// Cameras that the program knows.
#pragma once

#include <span>
#include <string_view>

#include "geometry/camera.h"

namespace rds {

// A camera that needs no file; config/<name>.yaml holds the same numbers, to be copied and changed.
struct NamedCamera {
  std::string_view name;
  PinholeCamera camera;
};

// tum_fr1, tum_fr2, tum_fr3, bonn, redkitchen.
std::span<const NamedCamera> BuiltInCameras();

// The known camera with these focal lengths and this principal point, or null: a file that says nothing of the sensor's
// noise and shutter is likely one of it.
[[nodiscard]] const NamedCamera* FindKnownCamera(const PinholeCamera& camera);

}  // namespace rds
