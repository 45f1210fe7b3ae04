// SPDX-License-Identifier: Apache-2.0
// Lens distortion: the forward model, and whether it can be undone.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "geometry/camera.h"

namespace rds {

// Where a point of the undistorted image plane (x = X / Z, y = Y / Z) comes to lie on the distorted one. Brown-Conrady
// with the rational radial term, or the equidistant fisheye model, both as OpenCV's documentation gives them.
[[nodiscard]] Eigen::Vector2d Distort(const PinholeCamera& camera, const Eigen::Vector2d& undistorted);

// What is wrong with a camera's distortion: from the principal point outwards, each pixel of the image must come from a
// direction of its own, less than 80 degrees off the optical axis. Coefficients in another order or of another camera
// rarely pass. Nothing if it is usable.
[[nodiscard]] std::optional<std::string> DistortionProblem(const PinholeCamera& camera);

}  // namespace rds
