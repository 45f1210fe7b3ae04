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
//     kind: logits          # or labels: whole numbers, one a cell; mask: how dynamic a cell is, 0 to 1 or to 255; or
//                           # instances: boxes with a score, a class and a mask each, for one image at a time
//     layout: NCHW          # or NHWC; of logits
//     stride: [0, 0]        # y, x: input pixels from cell to cell; 0 = first and last cell on the first and last pixel
//     offset: [0, 0]        # y, x: input pixel under the center of the first cell
//     names: ""             # file beside this one with the name of each class, a line each from class 0 on; then
//                           # option semantic.dynamic_classes says by name what is dynamic
//     labels: [15]          # prior dynamic classes, where there are no names: their union is the mask
//     threshold: 0.3        # on the sum of their probabilities: above, a pixel is dynamic
//     unsure: 0.05          # above, up to the threshold, it says nothing
//   instances:              # of kind instances; masks are those of the whole image or, if smaller, of their boxes
//     boxes: boxes          # names of the tensors: corners, four an instance
//     scores: scores
//     classes: labels
//     masks: masks
//     order: xyxy           # or yxyx
//     relative: false       # corners in pixels of the network's input; true: 0 to 1
//     score: 0.5            # instances below are left out
//   ignore_rounding: false  # run a quantized network in floats: faster here than imitating its rounding
struct SegmentationModel {
  enum class Output { kLogits, kLabels, kMask, kInstances };
  enum class BoxOrder { kXyxy, kYxyx };

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
  std::vector<std::string> names;         // of the classes; empty = unknown
  std::vector<int> labels = {15};
  double threshold = 0.3;
  double unsure = 0.05;
  std::string boxes_tensor = "boxes";
  std::string scores_tensor = "scores";
  std::string classes_tensor = "labels";
  std::string masks_tensor = "masks";
  BoxOrder box_order = BoxOrder::kXyxy;
  bool boxes_are_relative = false;
  double score = 0.5;
  bool ignore_rounding = false;

  // Where the output's cells lie, for a network input and output of these sizes.
  [[nodiscard]] ScoreGrid Grid(int network_height, int network_width, int output_height, int output_width) const;
  // Cells that are the pixels of the network's input.
  [[nodiscard]] ScoreGrid PixelGrid(int network_height, int network_width) const;
};

// Whether there is a description of these weights, right or wrong: `<weights>.yaml`, or the built-in one.
[[nodiscard]] bool HasDescription(const std::string& weights);

// The description in `<weights>.yaml` (the whole name with .yaml after it), else the built-in one for the published
// files and their derivatives, known by file name. Throws InputError for missing or unreadable weights (naming the file
// and `rds fetch weights`), for weights nobody describes, and for unknown keys or bad values in the YAML.
[[nodiscard]] SegmentationModel LoadSegmentationModel(const std::string& weights);

// The description of a network that runs elsewhere: from a YAML file as above or, where `description` is none, the
// built-in one for that file name without its extension ("deeplabv3_mnv2_361x481"). `name` is taken for messages.
[[nodiscard]] SegmentationModel DescribeRemoteModel(const std::string& name, const std::string& description);
// Whether there is a built-in one.
[[nodiscard]] bool HasBuiltInDescription(const std::string& name);

// Makes the classes called `dynamic_classes` ("person, cat") the dynamic ones. A model that names no classes keeps its
// labels where only the default is asked for. Throws InputError for names that the model does not have.
void ChooseDynamicClasses(SegmentationModel& model, const std::string& dynamic_classes);

// The description as YAML, to be read back by LoadSegmentationModel; names of classes are left out.
[[nodiscard]] std::string ToYaml(const SegmentationModel& model);

}  // namespace rds
