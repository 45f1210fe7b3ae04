// Frames of a sequence, decoded ahead on a thread of their own.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "geometry/camera.h"
#include "io/dataset.h"
#include "system/frame.h"

namespace rds {

// Reads the frames of a dataset in order, a few ahead, so that decoding takes no time from tracking. `dataset` must
// outlive it. Next is called from one thread.
class FrameSource {
 public:
  FrameSource(const Dataset& dataset, const PinholeCamera& camera);
  ~FrameSource();
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  // The next frame; waits for it if need be. Nothing: the end. Throws what reading it threw (InputError).
  [[nodiscard]] std::optional<RgbdFrame> Next();

  // CPU time spent on reading so far, in seconds.
  [[nodiscard]] double CpuSeconds() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
