// SPDX-License-Identifier: Apache-2.0
// What a segmentation network wants and gives: read from the small YAML file beside its weights.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "segmentation/mask.h"

namespace rds {

// Describes one weights file. In YAML (every key may be left out; these are the defaults):
//
//   input:
//     layout: NCHW          # or NHWC
//     size: [0, 0]          # height, width; 0 = as the file says; else a fully convolutional network is reshaped
//     color: RGB            # or BGR
//     mean: [0, 0, 0]       # the network gets (value - mean) / scale of values 0 .. 255, in its order of channels
//     scale: [1, 1, 1]
//   output:
//     tensor: ""            # end the graph at this tensor (before a last big resize and arg-max); "" = at its own end
//     kind: logits          # or labels: whole numbers, one a cell
//     layout: NCHW          # or NHWC; of logits
//     stride: [0, 0]        # y, x: input pixels from cell to cell; 0 = first and last cell on the first and last pixel
//     offset: [0, 0]        # y, x: input pixel under the center of the first cell
//     labels: [15]          # prior dynamic classes: their union is the mask
//     threshold: 0.3        # on the sum of their probabilities: above, a pixel is dynamic
//     unsure: 0.05          # above, up to the threshold, it says nothing
//   ignore_rounding: false  # run a quantized network in floats: faster here than imitating its rounding
struct SegmentationModel {
  enum class Output { kLogits, kLabels };

  std::string weights;  // the file described
  ChannelOrder input_order = ChannelOrder::kFirst;
  int input_height = 0;
  int input_width = 0;
  bool input_is_rgb = true;
  std::array<float, 3> mean = {0, 0, 0};
  std::array<float, 3> scale = {1, 1, 1};
  std::string output_tensor;
  Output output = Output::kLogits;
  ChannelOrder output_order = ChannelOrder::kFirst;
  std::array<double, 2> stride = {0, 0};  // y, x
  std::array<double, 2> offset = {0, 0};  // y, x
  std::vector<int> labels = {15};
  double threshold = 0.3;
  double unsure = 0.05;
  bool ignore_rounding = false;

  // Where the output's cells lie, for a network input and output of these sizes.
  [[nodiscard]] ScoreGrid Grid(int network_height, int network_width, int output_height, int output_width) const;
};

// Whether there is a description of these weights, right or wrong: `<weights>.yaml`, or the built-in one.
[[nodiscard]] bool HasDescription(const std::string& weights);

// The description in `<weights>.yaml` (the whole name with .yaml after it), else the built-in one for the published
// files and their derivatives, known by file name. Throws InputError for missing or unreadable weights (naming the file
// and `rds fetch weights`), for weights nobody describes, and for unknown keys or bad values in the YAML.
[[nodiscard]] SegmentationModel LoadSegmentationModel(const std::string& weights);

// The description as YAML, to be read back by LoadSegmentationModel.
[[nodiscard]] std::string ToYaml(const SegmentationModel& model);

}  // namespace rds
