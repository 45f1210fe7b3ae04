// SPDX-License-Identifier: Apache-2.0
// Pixels that show what is fixed to the camera: a robot's body, text burnt into the picture.
#pragma once

#include <filesystem>

#include "base/image.h"
#include "geometry/camera.h"

namespace rds {

// What is ignored of every frame. A value; safe to use from several threads at once.
class IgnoredPixels {
 public:
  IgnoredPixels() = default;  // nothing
  // Of a mask of the camera's size, 255 = ignored. Depth is left out to 20 pixels around it (at an image width of 640):
  // corners at the border of what is ignored are fixed to the camera, too.
  explicit IgnoredPixels(Image8 mask);

  [[nodiscard]] bool empty() const { return mask_.empty(); }
  // Paints them gray, which has no corners, and takes their depth away. Images of the mask's size.
  void Apply(Image8& color, Image16& depth) const;

 private:
  Image8 mask_;
  Image8 around_;
};

// From an image file: black = used, everything else ignored. InputError, naming the file, if it cannot be read, has not
// the camera's size, or leaves less than a tenth of the image.
[[nodiscard]] IgnoredPixels LoadIgnoredPixels(const std::filesystem::path& path, const PinholeCamera& camera);

}  // namespace rds
