// SPDX-License-Identifier: Apache-2.0
// Matchers for tests. Header only: the rest of testing/ does without GoogleTest.
#pragma once

#include <gmock/gmock.h>

#include <numbers>

#include "geometry/rigid3.h"

namespace rds {

// Passes for a Rigid3 whose translation differs by at most `tolerance_m` meters and whose rotation by at most
// `tolerance_deg` degrees from `expected`.
MATCHER_P3(RigidNear, expected, tolerance_m, tolerance_deg, "is near the expected pose") {
  const double distance_m = (arg.translation - expected.translation).norm();
  const double angle_deg = AngleOf(expected.rotation.conjugate() * arg.rotation) * 180.0 / std::numbers::pi;
  *result_listener << "off by " << distance_m << " m and " << angle_deg << " degrees";
  return distance_m <= tolerance_m && angle_deg <= tolerance_deg;
}

// Passes for an Eigen vector or matrix whose coefficients differ by at most `tolerance` from `expected`.
MATCHER_P2(MatrixNear, expected, tolerance, "is near the expected matrix") {
  const double difference = (arg - expected).cwiseAbs().maxCoeff();
  *result_listener << "greatest difference of a coefficient is " << difference;
  return difference <= tolerance;
}

}  // namespace rds
