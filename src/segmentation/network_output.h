// SPDX-License-Identifier: Apache-2.0
// From the tensors that a network gives, wherever it ran, to a mask.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "segmentation/segmentation_model.h"

namespace rds {

// One output of a network, whole numbers as floats, row-major. A dimension of the shape for the images of a batch comes
// first, but for instances.
struct OutputTensor {
  std::vector<std::int64_t> shape;
  std::vector<float> values;
};

// What a pixel's probability is held against.
struct MaskThresholds {
  float dynamic = 0;
  float unsure = 0;
};

// Those of the model, where options do not overrule them: `threshold` above 0, `unsure` from 0.
[[nodiscard]] MaskThresholds ThresholdsOf(const SegmentationModel& model, double threshold, double unsure);

// Names of the tensors that a mask is made of, in the order that MaskOfOutput wants them; {""} = the only one.
[[nodiscard]] std::vector<std::string> OutputNames(const SegmentationModel& model);

// The mask, width x height pixels, of the image that is `index`-th in the batch (instances: of the only one).
// `network_height` x `network_width`: the network's input, which the image was stretched to. InputError where the
// tensors are not what the model's description says. Stateless.
[[nodiscard]] Image8 MaskOfOutput(const SegmentationModel& model, const MaskThresholds& thresholds,
                                  std::span<const OutputTensor> outputs, std::size_t index, int network_height,
                                  int network_width, int width, int height);

}  // namespace rds
