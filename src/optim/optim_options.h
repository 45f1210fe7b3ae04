// SPDX-License-Identifier: Apache-2.0
// Options of the solvers.
#pragma once

namespace rds {

struct PoseOptimizerOptions {
  int rounds = 4;                 // inliers are classified anew after each
  int iterations_per_round = 10;  // at most; a round ends when the step is tiny
  int robust_rounds = 2;          // the first rounds with the Huber kernel; later ones plain least squares on inliers
};

struct BundleOptions {
  int robust_iterations = 5;    // with the Huber kernel on everything
  int final_iterations = 5;     // without the outliers found by then; 0 = skip
  double huber_mono = 2.4477;   // sqrt(5.991), px
  double huber_depth = 2.7955;  // sqrt(7.815), px
};

}  // namespace rds
