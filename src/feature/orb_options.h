// SPDX-License-Identifier: Apache-2.0
// Options of feature extraction.
#pragma once

namespace rds {

struct OrbOptions {
  int features = 1000;           // keypoints wanted
  int levels = 8;                // pyramid levels
  double scale_factor = 1.2;     // between levels
  int fast_threshold = 20;       // gray values
  int min_fast_threshold = 7;    // used in cells where the first threshold finds nothing
  bool depth_edges = true;       // mark keypoints at edges of the depth image
  double moving_ratio = 0.1;     // additional keypoints on dynamic surfaces, of those of each coarse level
  double boundary_ratio = 0.15;  // additional keypoints at their boundary, of those of each level
};

}  // namespace rds
