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
  bool depth_edges = true;       // look for jumps of the depth around each keypoint, and holes where it is near
  double moving_ratio = 0.1;     // of each coarse level's: keypoints wanted in addition on what moves
  double boundary_ratio = 0.15;  // of each level's: those wanted in addition beside it
};

}  // namespace rds
