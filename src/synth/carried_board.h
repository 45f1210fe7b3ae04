// SPDX-License-Identifier: Apache-2.0
// A thing without a name that moves before the camera.
#pragma once

#include <cstdint>
#include <memory>

#include "synth/camera_path.h"
#include "synth/scene.h"

namespace rds::synthetic {

// A printed board that somebody out of view carries about a meter before the camera, to and fro, from the first moment
// on: it fills about a quarter of the picture and hides what is behind it. Immutable.
class CarriedBoard {
 public:
  explicit CarriedBoard(std::uint64_t seed);

  [[nodiscard]] Quad At(const CameraPath& camera, double time_s) const;

 private:
  std::shared_ptr<const Texture> texture_;
};

}  // namespace rds::synthetic
