// SPDX-License-Identifier: Apache-2.0
// Options of the propagation of labels along surfaces and through space.
#pragma once

#include "geometry/depth_ratio.h"

namespace rds {

struct SurfaceLabelOptions {
  int max_dynamic_distance_px = 255;  // over which a dynamic label spreads along a surface, below SurfaceLabel::kNone
  int max_static_distance_px = 100;   // the same for a static one
  double depth_step_ratio = depth_ratio::kNextSample;  // largest step between neighboring samples of a surface

  [[nodiscard]] int MaxDistance(bool dynamic) const {
    return dynamic ? max_dynamic_distance_px : max_static_distance_px;
  }
};

struct PropagationOptions {
  bool enabled = true;
  int age_penalty_px = 4;  // distance that a label ages by with each frame
  SurfaceLabelOptions surface;
};

struct FreeSpaceOptions {
  bool enabled = true;
  double margin_ratio =
      depth_ratio::kLookedBeyond;  // by which an earlier view must have seen beyond a place, as a ratio of the depth
  double match_ratio =
      depth_ratio::kStaticAgain;  // difference up to which a surface is the same, as a ratio of its depth
};

}  // namespace rds
