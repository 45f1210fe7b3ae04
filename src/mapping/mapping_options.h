// SPDX-License-Identifier: Apache-2.0
// Options of local mapping.
#pragma once

#include "optim/optim_options.h"

namespace rds {

struct LocalBundleOptions {
  int keyframes = 20;         // optimized at most: the newest and its best covisible ones
  int fixed_keyframes = 20;   // others that see the same points, held fixed, at most
  bool weighted = true;       // residuals weighted by 1 - p (equation 6), points known as dynamic left out
  bool labeled_only = false;  // only keyframes with semantic information, once there are enough
  int enough_labeled = 3;     // keyframes; with fewer the newest keyframes take part without labels
  BundleOptions solver;
};

struct MappingOptions {
  int probation_keyframes = 3;     // keyframes for which a new point is on probation
  double min_found_ratio = 0.25;   // of the frames that should see it, for a point on probation
  int min_observations = 2;        // that a point needs two keyframes after it was made
  int triangulate_neighbors = 10;  // keyframes with which new points are triangulated
  double triangulate_ratio = 0.8;  // ratio test of that search
  int fuse_neighbors = 10;         // best covisible keyframes; each brings its best five
  double redundant_ratio = 0.95;   // of a keyframe's close points well observed without it: the keyframe goes
  int redundant_observations = 3;
  int cull_keyframes = 20;  // best covisible keyframes that are examined
  LocalBundleOptions bundle;
};

}  // namespace rds
