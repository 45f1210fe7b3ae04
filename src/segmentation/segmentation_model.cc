// SPDX-License-Identifier: Apache-2.0
#include "segmentation/segmentation_model.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/strict_yaml.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/yaml_mapping.h"
#include "segmentation/segmenter_options.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// One of two words: true for the first.
void ReadChoice(const YamlMapping& map, const std::string& key, bool& is_first, const std::string& first,
                const std::string& second) {
  std::string word = is_first ? first : second;
  const std::string wanted = first + " or " + second;
  map.Read(key, word, wanted);
  if (word != first && word != second) {
    map.Refuse(key, wanted);
  }
  is_first = word == first;
}

void ReadOrder(const YamlMapping& map, const std::string& key, ChannelOrder& order) {
  bool first = order == ChannelOrder::kFirst;
  ReadChoice(map, key, first, "NCHW", "NHWC");
  order = first ? ChannelOrder::kFirst : ChannelOrder::kLast;
}

bool AllFinite(const std::array<double, 2>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void ReadInput(const YamlMapping& input, SegmentationModel& model) {
  ReadOrder(input, "layout", model.input_order);
  std::array<int, 2> size = {model.input_height, model.input_width};
  input.Read("size", size, "[height, width]");
  if (size[0] < 0 || size[1] < 0 || size[0] > 8192 || size[1] > 8192 || (size[0] == 0) != (size[1] == 0)) {
    input.Refuse("size", "[height, width], both positive, or both 0");
  }
  model.input_height = size[0];
  model.input_width = size[1];
  ReadChoice(input, "color", model.input_is_rgb, "RGB", "BGR");
  input.Read("mean", model.mean, "three numbers");
  input.Read("scale", model.scale, "three numbers");
  const auto usable = [](float v) { return std::isfinite(v); };
  if (!std::all_of(model.mean.begin(), model.mean.end(), usable)) {
    input.Refuse("mean", "three finite numbers");
  }
  if (!std::all_of(model.scale.begin(), model.scale.end(), [&](float v) { return usable(v) && v > 0; })) {
    input.Refuse("scale", "three numbers above 0");
  }
}

constexpr std::array<const char*, 4> kKinds = {"logits", "labels", "mask", "instances"};

void ReadKind(const YamlMapping& output, SegmentationModel& model) {
  std::string kind = kKinds[static_cast<std::size_t>(model.output)];
  output.Read("kind", kind, "a word");
  const auto* const found = std::ranges::find(kKinds, kind);
  if (found == kKinds.end()) {
    output.Refuse("kind", fmt::format("one of {}", fmt::join(kKinds, ", ")));
  }
  model.output = static_cast<SegmentationModel::Output>(found - kKinds.begin());
}

// A line a class. Blanks around names are left out, and so are empty lines at the end.
std::vector<std::string> ReadNames(const fs::path& file) {
  std::vector<std::string> names;
  std::istringstream lines(ReadFile(file));
  for (std::string line; std::getline(lines, line);) {
    names.emplace_back(Trimmed(line));
  }
  while (!names.empty() && names.back().empty()) {
    names.pop_back();
  }
  if (names.empty()) {
    throw InputError(file.string() + ": names no classes; a line with a name is wanted for each, from class 0 on");
  }
  return names;
}

void ReadInstances(const YamlMapping& instances, SegmentationModel& model) {
  instances.Read("boxes", model.boxes_tensor, "the name of a tensor");
  instances.Read("scores", model.scores_tensor, "the name of a tensor");
  instances.Read("classes", model.classes_tensor, "the name of a tensor");
  instances.Read("masks", model.masks_tensor, "the name of a tensor");
  bool x_first = model.box_order == SegmentationModel::BoxOrder::kXyxy;
  ReadChoice(instances, "order", x_first, "xyxy", "yxyx");
  model.box_order = x_first ? SegmentationModel::BoxOrder::kXyxy : SegmentationModel::BoxOrder::kYxyx;
  instances.Read("relative", model.boxes_are_relative, "true or false");
  instances.Read("score", model.score, "a number from 0 to 1");
  if (!(model.score >= 0 && model.score <= 1)) {
    instances.Refuse("score", "from 0 to 1");
  }
}

void ReadOutput(const YamlMapping& output, SegmentationModel& model) {
  output.Read("tensor", model.output_tensor, "the name of a tensor");
  ReadKind(output, model);
  ReadOrder(output, "layout", model.output_order);
  output.Read("stride", model.stride, "[y, x] in pixels");
  output.Read("offset", model.offset, "[y, x] in pixels");
  if (!AllFinite(model.stride) || model.stride[0] < 0 || model.stride[1] < 0) {
    output.Refuse("stride", "[y, x], 0 or more pixels");
  }
  if (!AllFinite(model.offset)) {
    output.Refuse("offset", "[y, x] in pixels");
  }
  std::string names;
  output.Read("names", names, "the name of a file");
  if (!names.empty()) {
    model.names = ReadNames(output.file().parent_path() / names);
  }
  output.Read("labels", model.labels, "a list of class numbers");
  if (model.labels.empty() || *std::min_element(model.labels.begin(), model.labels.end()) < 0) {
    output.Refuse("labels", "a list of class numbers, at least one");
  }
  output.Read("threshold", model.threshold, "a number between 0 and 1");
  if (!(model.threshold > 0 && model.threshold < 1)) {
    output.Refuse("threshold", "between 0 and 1");
  }
  output.Read("unsure", model.unsure, "a number from 0 to the threshold");
  if (!(model.unsure >= 0 && model.unsure <= model.threshold)) {
    output.Refuse("unsure", "from 0 to the threshold");
  }
}

void ReadYaml(const std::string& file, SegmentationModel& model) {
  const YAML::Node root = ReadStrictYaml(file);
  const YamlMapping top(file, root, {"input", "output", "instances", "ignore_rounding"});
  ReadInput({file, top.At("input"), {"layout", "size", "color", "mean", "scale"}, "input"}, model);
  ReadOutput({file,
              top.At("output"),
              {"tensor", "kind", "layout", "stride", "offset", "names", "labels", "threshold", "unsure"},
              "output"},
             model);
  ReadInstances(
      {file, top.At("instances"), {"boxes", "scores", "classes", "masks", "order", "relative", "score"}, "instances"},
      model);
  top.Read("ignore_rounding", model.ignore_rounding, "true or false");
}

std::string DescriptionOf(const std::string& weights) { return weights + ".yaml"; }

// DeepLabV3 with MobileNetV2 on PASCAL VOC by Google: the published files and the float versions made from them. Their
// thresholds are low, because a person that is missed costs SLAM more than a bit of wall that is masked.
std::optional<SegmentationModel> BuiltIn(const std::string& file_name) {
  SegmentationModel model;
  model.names = {"background", "aeroplane", "bicycle",     "bird",  "boat",        "bottle", "bus",
                 "car",        "cat",       "chair",       "cow",   "diningtable", "dog",    "horse",
                 "motorbike",  "person",    "pottedplant", "sheep", "sofa",        "train",  "tvmonitor"};
  if (file_name == "deeplabv3_mnv2_pascal_quant.tflite" || file_name == "deeplabv3_mnv2_dm05_pascal_quant.tflite") {
    model.input_order = model.output_order = ChannelOrder::kLast;
    // Published for 513 x 513; fully convolutional, so it runs at the shape of a camera's image and less than half the
    // time, with the same masks.
    model.input_height = 369;
    model.input_width = 481;
    model.output_tensor = "ResizeBilinear_1";
    model.stride = {16, 16};
    model.ignore_rounding = true;
  } else if (file_name == "deeplabv3_mnv2_361x481.onnx" || file_name == "deeplabv3_mnv2_dm05_361x481.onnx") {
    model.stride = {16, 16};
    model.offset = {8, 0};  // 361 = 16 * 22 + 9: the last halving of the rows starts at the second one
  } else if (file_name == "deeplabv3_mnv2_os8_481x641.onnx") {
    model.stride = {8, 8};
  } else {
    return std::nullopt;
  }
  if (file_name.find("_dm05_") != std::string::npos) {
    model.threshold = 0.2;  // the half-width network is less sure of people
  }
  return model;
}

}  // namespace

ScoreGrid SegmentationModel::Grid(int network_height, int network_width, int output_height, int output_width) const {
  const auto step = [](double given, int input, int cells) {
    return given > 0 ? given : cells > 1 ? (input - 1.0) / (cells - 1.0) : static_cast<double>(input);
  };
  return {.width = output_width,
          .height = output_height,
          .stride_x = step(stride[1], network_width, output_width),
          .stride_y = step(stride[0], network_height, output_height),
          .offset_x = offset[1],
          .offset_y = offset[0],
          .input_width = network_width,
          .input_height = network_height};
}

ScoreGrid SegmentationModel::PixelGrid(int network_height, int network_width) const {
  return {
      .width = network_width, .height = network_height, .input_width = network_width, .input_height = network_height};
}

bool HasDescription(const std::string& weights) {
  std::error_code error;
  return fs::exists(DescriptionOf(weights), error) || BuiltIn(fs::path(weights).filename().string()).has_value();
}

SegmentationModel LoadSegmentationModel(const std::string& weights) {
  std::error_code error;
  if (!fs::is_regular_file(weights, error)) {
    throw InputError(fmt::format(
        "weights {}: no such file; fetch the published ones with `rds fetch weights`, or name others with --model",
        weights));
  }
  if (fs::file_size(weights, error) == 0 || error) {
    throw InputError(
        fmt::format("weights {}: empty or unreadable; fetch them again with `rds fetch weights`", weights));
  }
  const std::string description = DescriptionOf(weights);
  std::optional<SegmentationModel> model = BuiltIn(fs::path(weights).filename().string());
  if (fs::exists(description, error)) {
    model = SegmentationModel{};
    ReadYaml(description, *model);
  } else if (!model) {
    throw InputError(
        fmt::format("weights {}: nothing says what this network wants and gives; write {} (docs: the "
                    "comment in src/segmentation/segmentation_model.h lists the keys)",
                    weights, description));
  }
  model->weights = weights;
  return *model;
}

bool HasBuiltInDescription(const std::string& name) {
  return BuiltIn(name + ".onnx").has_value() || BuiltIn(name + ".tflite").has_value();
}

SegmentationModel DescribeRemoteModel(const std::string& name, const std::string& description) {
  SegmentationModel model;
  if (!description.empty()) {
    ReadYaml(description, model);
  } else if (const auto onnx = BuiltIn(name + ".onnx")) {
    model = *onnx;
  } else if (const auto tflite = BuiltIn(name + ".tflite")) {
    model = *tflite;
  }
  model.weights = name;
  return model;
}

void ChooseDynamicClasses(SegmentationModel& model, const std::string& dynamic_classes) {
  std::vector<std::string> wanted;
  const bool in_brackets = dynamic_classes.starts_with('[') && dynamic_classes.ends_with(']');
  std::istringstream words(in_brackets ? dynamic_classes.substr(1, dynamic_classes.size() - 2) : dynamic_classes);
  for (std::string word; std::getline(words, word, ',');) {
    if (const std::string_view name = Trimmed(word); !name.empty()) {
      wanted.emplace_back(name);
    }
  }
  if (wanted.empty()) {
    throw InputError("option semantic.dynamic_classes: names of classes are wanted, such as person, cat");
  }
  if (model.names.empty()) {
    if (wanted != std::vector<std::string>{kDefaultDynamicClass}) {
      throw InputError(
          fmt::format("option semantic.dynamic_classes: weights {} name no classes; say which file does "
                      "under output.names of {}",
                      model.weights, DescriptionOf(model.weights)));
    }
    return;
  }
  model.labels.clear();
  for (const std::string& name : wanted) {
    const auto found = std::ranges::find(model.names, name);
    if (found == model.names.end()) {
      throw InputError(fmt::format("option semantic.dynamic_classes: weights {} know no '{}'{}; there are {}",
                                   model.weights, name, Suggestion(name, model.names), fmt::join(model.names, ", ")));
    }
    model.labels.push_back(static_cast<int>(found - model.names.begin()));
  }
}

std::string ToYaml(const SegmentationModel& model) {
  const auto layout = [](ChannelOrder order) { return order == ChannelOrder::kFirst ? "NCHW" : "NHWC"; };
  return fmt::format(
      "input:\n"
      "  layout: {}\n"
      "  size: [{}, {}]\n"
      "  color: {}\n"
      "  mean: [{}]\n"
      "  scale: [{}]\n"
      "output:\n"
      "  tensor: \"{}\"\n"
      "  kind: {}\n"
      "  layout: {}\n"
      "  stride: [{}]\n"
      "  offset: [{}]\n"
      "  labels: [{}]\n"
      "  threshold: {}\n"
      "  unsure: {}\n"
      "instances:\n"
      "  boxes: \"{}\"\n"
      "  scores: \"{}\"\n"
      "  classes: \"{}\"\n"
      "  masks: \"{}\"\n"
      "  order: {}\n"
      "  relative: {}\n"
      "  score: {}\n"
      "ignore_rounding: {}\n",
      layout(model.input_order), model.input_height, model.input_width, model.input_is_rgb ? "RGB" : "BGR",
      fmt::join(model.mean, ", "), fmt::join(model.scale, ", "), model.output_tensor,
      kKinds[static_cast<std::size_t>(model.output)], layout(model.output_order), fmt::join(model.stride, ", "),
      fmt::join(model.offset, ", "), fmt::join(model.labels, ", "), model.threshold, model.unsure, model.boxes_tensor,
      model.scores_tensor, model.classes_tensor, model.masks_tensor,
      model.box_order == SegmentationModel::BoxOrder::kXyxy ? "xyxy" : "yxyx", model.boxes_are_relative, model.score,
      model.ignore_rounding);
}

}  // namespace rds
