// SPDX-License-Identifier: Apache-2.0
// The interface that segmentation back ends implement: images in, masks out, no map in sight.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/image.h"

namespace rds {

// One image to be segmented.
struct SegmentationInput {
  FrameId frame;
  double timestamp_s = 0;
  std::shared_ptr<const Image8> image;  // BGR or gray, as recorded
};

// A segmentation back end. Segment is called from one thread, never the tracking thread; Cancel from any thread.
class Segmenter {
 public:
  virtual ~Segmenter() = default;

  // Masks of the prior dynamic classes, one for each input, of the input's size, one channel, undilated, of the
  // pixels that mask.h names: dynamic, unsure, static. An empty image says "no answer for this one". Blocks as long as
  // it takes. May throw any std::exception: the caller logs it and goes on without these labels.
  [[nodiscard]] virtual std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) = 0;

  // Asks a Segment under way, and every later one, to return soon (with empty images). Returns at once.
  virtual void Cancel() = 0;

  // For reports, such as "stored, 200 ms" or "openvino, deeplabv3_mnv2_361x481.onnx".
  [[nodiscard]] virtual std::string Name() const = 0;
};

}  // namespace rds
