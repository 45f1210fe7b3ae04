// SPDX-License-Identifier: Apache-2.0
// A keypoint as the optimizers take it.
#pragma once

#include "feature/frame_data.h"
#include "optim/observation.h"

namespace rds {

// A corner where a near surface ends before a far one often belongs to neither: it is where their outlines cross, and
// moves as the camera does. Its position has so much less information.
inline constexpr double kEdgeInformation = 0.1;

[[nodiscard]] inline PixelObservation ObservationOf(const Keypoint& keypoint, const ScalePyramid& pyramid,
                                                    double weight) {
  PixelObservation observation;
  observation.pixel = keypoint.Pixel();
  observation.right_x = static_cast<double>(keypoint.right_x);
  observation.inverse_sigma2 = pyramid.inverse_sigma2[keypoint.octave] * (keypoint.at_edge ? kEdgeInformation : 1);
  observation.weight = weight;
  return observation;
}

}  // namespace rds
