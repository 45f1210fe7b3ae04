// SPDX-License-Identifier: Apache-2.0
// Noise of cameras: structured-light depth, and color.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "geometry/camera.h"

namespace rds::synthetic {

// Of a first-generation Kinect. Disparity = focal length * baseline / depth is measured with normal noise and rounded
// to eighths of a pixel, so that errors of depth grow with its square (Khoshelham and Oude Elberink, "Accuracy and
// resolution of Kinect depth data", Sensors 2012). No depth where the projector, which sits a baseline to the right, is
// hidden, beside edges, nearer than `near_m` and farther than `far_m`.
struct DepthNoise {
  double disparity_sigma_px = 0.06;
  double disparity_step_px = 0.125;
  double near_m = 0.4;
  double far_m = 4.5;
  double edge_jump = 0.04;  // relative step of depth that counts as an edge
  double edge_loss = 0.6;   // probability that a pixel beside an edge has no depth
};

inline constexpr double kColorSigma = 2.0;  // gray values, each pixel and channel by itself

// Exact depths in meters (0 = none) to the camera's units, rounded to the nearest; out of the type's range becomes 0.
Image16 QuantizeDepth(const std::vector<float>& depth_m, const PinholeCamera& camera);
// The same as the sensor measures it. Same seed, same bytes.
Image16 MeasureDepth(const std::vector<float>& depth_m, const PinholeCamera& camera, const DepthNoise& noise,
                     std::uint64_t seed);
// Floats to bytes, with normal noise of `sigma` gray values; sigma 0 only rounds.
Image8 MeasureColor(const std::vector<float>& color, const PinholeCamera& camera, double sigma, std::uint64_t seed);

}  // namespace rds::synthetic
