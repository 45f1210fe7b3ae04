// SPDX-License-Identifier: Apache-2.0
// Frames of a sequence, decoded ahead on a thread of their own.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "geometry/camera.h"
#include "io/dataset.h"
#include "system/frame.h"

namespace rds {

// One frame of a sequence, or why it cannot be had.
struct SourceFrame {
  std::size_t index = 0;
  std::optional<RgbdFrame> frame;  // nothing: its files cannot be read
  std::string problem{};           // then: why
};

// Reads the frames of a dataset in order, a few ahead, so that decoding takes no time from tracking. `dataset` must
// outlive it. Next is called from one thread.
class FrameSource {
 public:
  FrameSource(const Dataset& dataset, const PinholeCamera& camera);
  ~FrameSource();
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  // The next frame; waits for it if need be. Nothing: the end. Bad files are part of what it gives; throws other errors
  // of reading (no memory).
  [[nodiscard]] std::optional<SourceFrame> Next();

  // CPU time spent on reading so far, in seconds.
  [[nodiscard]] double CpuSeconds() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
