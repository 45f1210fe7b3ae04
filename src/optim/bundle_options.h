// SPDX-License-Identifier: Apache-2.0
// Options of bundle adjustment.
#pragma once

namespace rds {

struct BundleOptions {
  int robust_iterations = 5;    // with the Huber kernel on everything
  int final_iterations = 5;     // without the outliers found by then; 0 = skip
  double huber_mono = 2.4477;   // sqrt(5.991), px
  double huber_depth = 2.7955;  // sqrt(7.815), px
};

}  // namespace rds
