// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment: poses and points refined together. Problem in, result out, no map inside.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "optim/observation.h"
#include "optim/optim_options.h"

namespace rds {

// A self-contained copy of the part of a map to be optimized. Points and poses without observations are left alone, so
// are observations of weight 0. If no pose is fixed, the first one is held nevertheless: without one the solution could
// drift anywhere.
struct BundleProblem {
  struct Pose {
    Rigid3 camera_from_world;
    bool fixed = false;
  };
  struct Observation {
    std::uint32_t pose = 0;   // index into poses
    std::uint32_t point = 0;  // index into points
    PixelObservation keypoint;
  };

  PinholeCamera camera;
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;  // in the world frame
  std::vector<Observation> observations;
};

struct BundleResult {
  std::vector<Rigid3> poses;            // camera_from_world, as in the problem; fixed ones unchanged
  std::vector<Eigen::Vector3d> points;  // in the world frame
  std::vector<std::uint8_t> outlier;    // one for each observation: chi2 above the 95 % quantile or behind the camera
  bool usable = false;                  // false: nothing to optimize, the solver failed or was stopped before one step
  int iterations = 0;                   // of both stages
  double initial_cost = 0;              // half the sum of squares, with the Huber kernel on everything
  double final_cost = 0;                // of the last stage, without the outliers then known
};

// Levenberg-Marquardt with the points eliminated first (Triggs et al., "Bundle adjustment: a modern synthesis", 1999),
// as local bundle adjustment in ORB-SLAM (Mur-Artal et al., T-RO 2015, section VI). Solves on the calling thread
// (deterministic). `stop` is polled between iterations; when it returns true the best state so far is returned.
// Re-entrant. Throws InvariantError on indices out of range.
[[nodiscard]] BundleResult AdjustBundle(const BundleProblem& problem, const BundleOptions& options = {},
                                        const std::function<bool()>& stop = {});

}  // namespace rds
