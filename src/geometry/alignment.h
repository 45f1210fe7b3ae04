// SPDX-License-Identifier: Apache-2.0
// Least-squares alignment of point sets.
#pragma once

#include <Eigen/Core>
#include <span>

#include "geometry/rigid3.h"

namespace rds {

// target = scale * (b_from_a * source) in the least-squares sense, b_from_a being the rigid part:
// target ~ scale * rotation * source + translation.
struct Alignment {
  double scale = 1;
  Rigid3 target_from_source;
  [[nodiscard]] Eigen::Vector3d Apply(const Eigen::Vector3d& point) const {
    return scale * (target_from_source.rotation * point) + target_from_source.translation;
  }
};

// Umeyama, "Least-squares estimation of transformation parameters between two point patterns", PAMI 1991. Both spans
// have the same size >= 3 (else InputError). Scale is 1 unless `with_scale`.
Alignment Align(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target, bool with_scale);

}  // namespace rds
