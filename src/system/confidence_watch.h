// SPDX-License-Identifier: Apache-2.0
// Says, once, that poses may follow the wrong thing.
#pragma once

#include <optional>

namespace rds {

// Below this share of the depth image explained (FrameResult::confidence) a pose is in doubt.
inline constexpr double kUnexplained = 0.5;

// Warns on the log when the confidence stays low: a moment of it is somebody who walks by. One caller.
class ConfidenceWatch {
 public:
  // That of each frame; absent: nothing is known. Whether this frame was the one to warn of.
  bool Add(std::optional<double> confidence, bool has_semantics);

 private:
  static constexpr int kLong = 20;  // frames on end

  int low_ = 0;
  bool warned_ = false;
};

}  // namespace rds
