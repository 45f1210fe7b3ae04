// SPDX-License-Identifier: Apache-2.0
// Pose graph optimization: poses that agree best with what is known of pairs of them. Problem in, result out.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/rigid3.h"

namespace rds {

// Cameras (camera_from_world) and the relative poses that were measured between them.
struct PoseGraphProblem {
  struct Pose {
    Rigid3 camera_from_world;
    bool fixed = false;
  };
  struct Edge {
    std::uint32_t from = 0;  // indices into poses
    std::uint32_t to = 0;
    Rigid3 to_from_from;
    double sigma_m = 0.005;  // standard deviation for each axis
    double sigma_rad = 0.0035;
    bool robust = false;  // may be wrong: its weight falls where it contradicts the rest
  };
  std::vector<Pose> poses;  // at least one is fixed
  std::vector<Edge> edges;
};

struct PoseGraphResult {
  std::vector<Rigid3> poses;  // camera_from_world, as in the problem
  std::vector<double> chi2;   // one for each edge, 6 degrees of freedom, unweighted by the kernel
  bool usable = false;        // false: nothing to optimize, or it did not come to an end
  int iterations = 0;
};

// Levenberg-Marquardt on SE(3) with the residuals of Grisetti et al. ("A tutorial on graph-based SLAM", 2010), robust
// edges with dynamic covariance scaling (Agarwal et al., ICRA 2013). On the calling thread; re-entrant; the same input
// gives the same result. `stop` is polled between iterations. Throws InvariantError on indices out of range.
[[nodiscard]] PoseGraphResult OptimizePoseGraph(const PoseGraphProblem& problem, int iterations = 20,
                                                const std::function<bool()>& stop = {});

}  // namespace rds
