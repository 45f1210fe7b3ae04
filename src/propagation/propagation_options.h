// SPDX-License-Identifier: Apache-2.0
// Options of the propagation of labels along surfaces and through space.
#pragma once

#include "geometry/depth_ratio.h"

namespace rds {

struct SurfaceLabelOptions {
  int max_dynamic_distance_px = 255;  // how far a label of what moves spreads over a surface, below SurfaceLabel::kNone
  int max_static_distance_px = 100;   // and one of what does not
  double depth_step_ratio =
      depth_ratio::kNextSample;  // neighboring samples on a surface differ in depth by at most this share

  [[nodiscard]] int MaxDistance(bool dynamic) const {
    return dynamic ? max_dynamic_distance_px : max_static_distance_px;
  }
};

struct PropagationOptions {
  bool enabled = true;
  int age_penalty_px = 4;  // a label is as if so much farther away with each frame that it is carried
  SurfaceLabelOptions surface;
};

struct FreeSpaceOptions {
  bool enabled = true;
  double margin_ratio =
      depth_ratio::kLookedBeyond;  // an earlier view must have looked that much farther, as a share of the depth
  double match_ratio = depth_ratio::kStaticAgain;  // a surface is the same one up to this share of its depth
};

}  // namespace rds
