// SPDX-License-Identifier: Apache-2.0
// The reference that makes times on different machines comparable: OpenCV's ORB on the same images in the same run.
#pragma once

#include <memory>
#include <vector>

#include "cli/playback.h"

namespace rds {

// Times cv::ORB (1000 features, 8 levels, factor 1.2, the calling thread only) on each frame's gray image, just before
// the frame is tracked. The conversion to gray is not part of it.
class ReferenceTiming final : public PlaybackObserver {
 public:
  ReferenceTiming();
  ~ReferenceTiming() override;
  ReferenceTiming(const ReferenceTiming&) = delete;
  ReferenceTiming& operator=(const ReferenceTiming&) = delete;

  void BeforeFrame(const RgbdFrame& frame) override;

  // Wall time for each frame.
  [[nodiscard]] const std::vector<double>& times_ms() const;
  // CPU time of all that BeforeFrame did.
  [[nodiscard]] double cpu_s() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
