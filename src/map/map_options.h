// SPDX-License-Identifier: Apache-2.0
// Options of the map.
#pragma once

namespace rds {

// The paper's section IV-D.
struct MovingProbabilityOptions {
  double alpha = 0.9;          // p(labeled dynamic | dynamic)
  double beta = 0.9;           // p(labeled static | static)
  double static_below = 0.4;   // theta_s
  double dynamic_above = 0.6;  // theta_d
  double floor = 0.02;         // p stays within [floor, 1 - floor], so that a point can change its mind
};

struct LocalMapOptions {
  int keyframes = 40;  // at most, in a snapshot
  int neighbors = 10;  // best covisible keyframes that each covisible keyframe brings along
};

}  // namespace rds
