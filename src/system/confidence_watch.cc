// SPDX-License-Identifier: Apache-2.0
#include "system/confidence_watch.h"

#include "base/log.h"

namespace rds {

bool ConfidenceWatch::Add(std::optional<double> confidence, bool has_semantics) {
  if (!confidence) {
    return false;
  }
  low_ = *confidence < kUnexplained ? low_ + 1 : 0;
  if (warned_ || low_ < kLong) {
    return false;
  }
  warned_ = true;
  log::warn(
      "for {} frames on end the pose has explained less than {:.0f} % of the depth image: either nearly all that is "
      "seen moves, or the pose follows something that moves{}; what is fixed to the camera can be left out with "
      "semantic.ignore",
      kLong, 100 * kUnexplained, has_semantics ? "" : "; --segmenter geometry tells the two apart, without a network");
  return true;
}

}  // namespace rds
