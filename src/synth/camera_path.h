// SPDX-License-Identifier: Apache-2.0
// Smooth hand-held camera motions through the synthetic room.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/rigid3.h"
#include "synth/synthetic_options.h"

namespace rds::synthetic {

// A motion without end: about .3 m/s and 10 to 25 degrees a second (kStatic: a few millimeters of sway), with the
// tremor of a hand. Immutable.
class CameraPath {
 public:
  CameraPath(SyntheticPath path, std::uint64_t seed);

  // Camera frame: x right, y down, z forward; world: z up, meters.
  [[nodiscard]] Rigid3 WorldFromCamera(double time_s) const;

 private:
  // A sum of two sinusoids of the seed's phases: slow with amplitude 1, fast with amplitude .25.
  [[nodiscard]] double Tremor(std::size_t axis, double time_s) const;

  SyntheticPath path_;
  std::array<double, 24> phases_{};
};

}  // namespace rds::synthetic
