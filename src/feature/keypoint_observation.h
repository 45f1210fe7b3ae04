// SPDX-License-Identifier: Apache-2.0
// A keypoint as the optimizers take it.
#pragma once

#include "feature/frame_data.h"
#include "optim/observation.h"

namespace rds {

// A corner where a near surface ends before a far one often belongs to neither: it is where their outlines cross, and
// moves as the camera does. Its position has so much less information.
inline constexpr double kEdgeInformation = 0.1;

// What makes pixels of an inverse depth (PixelObservation::depth_px). The keypoint has depth.
[[nodiscard]] inline double DepthPixels(const Keypoint& keypoint, const ScalePyramid& pyramid) {
  const auto depth_m = static_cast<double>(keypoint.depth_m);
  return depth_m * depth_m / static_cast<double>(keypoint.depth_sigma_m) *
         static_cast<double>(pyramid.scale[keypoint.octave]);
}

[[nodiscard]] inline PixelObservation ObservationOf(const Keypoint& keypoint, const ScalePyramid& pyramid,
                                                    double weight) {
  PixelObservation observation;
  observation.pixel = keypoint.Pixel();
  if (keypoint.HasDepth()) {
    observation.inverse_depth = 1 / static_cast<double>(keypoint.depth_m);
    observation.depth_px = DepthPixels(keypoint, pyramid);
  }
  observation.inverse_sigma2 = pyramid.inverse_sigma2[keypoint.octave] * (keypoint.at_edge ? kEdgeInformation : 1);
  observation.weight = weight;
  return observation;
}

}  // namespace rds
