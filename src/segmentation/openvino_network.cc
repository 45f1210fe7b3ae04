// SPDX-License-Identifier: Apache-2.0
#include "segmentation/openvino_network.h"

#ifdef RDS_WITH_OPENVINO

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <openvino/core/preprocess/pre_post_process.hpp>
#include <openvino/frontend/manager.hpp>
#include <openvino/op/interpolate.hpp>
#include <openvino/openvino.hpp>
#include <openvino/opsets/opset8.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "segmentation/network_output.h"

namespace rds {
namespace {

namespace op = ov::opset8;

ov::Output<ov::Node> TensorOf(const ov::Model& network, const std::string& name) {
  for (const std::shared_ptr<ov::Node>& node : network.get_ordered_ops()) {
    for (const ov::Output<ov::Node>& output : node->outputs()) {
      if (output.get_names().count(name) > 0) {
        return output;
      }
    }
  }
  throw InputError(fmt::format("output.tensor: the network has no tensor '{}'", name));
}

// Makes the tensors of these names the network's only outputs, so that what comes after them is not computed.
std::shared_ptr<ov::Model> EndAt(const ov::Model& network, const std::vector<std::string>& names) {
  ov::ResultVector results;
  for (const std::string& name : names) {
    results.push_back(std::make_shared<ov::op::v0::Result>(TensorOf(network, name)));
  }
  return std::make_shared<ov::Model>(results, network.get_parameters());
}

// The value of a constant input that holds one number, if it is that.
std::optional<float> ConstantScalar(const ov::Output<ov::Node>& output) {
  const auto constant = std::dynamic_pointer_cast<op::Constant>(output.get_node_shared_ptr());
  if (!constant || ov::shape_size(constant->get_shape()) != 1) {
    return std::nullopt;
  }
  return constant->cast_vector<float>().front();
}

// What a FakeQuantize computes apart from its rounding: x clamped to the input range, mapped to the output range.
// Nothing if its ranges are not single numbers.
std::optional<ov::Output<ov::Node>> WithoutRounding(const std::shared_ptr<ov::Node>& node) {
  std::array<float, 4> range{};
  for (std::size_t i = 0; i < range.size(); ++i) {
    const std::optional<float> value = ConstantScalar(node->input_value(i + 1));
    if (!value) {
      return std::nullopt;
    }
    range[i] = *value;
  }
  const auto [in_low, in_high, out_low, out_high] = range;
  if (!(in_high > in_low)) {
    return std::nullopt;
  }
  const ov::Output<ov::Node> x = node->input_value(0);
  const ov::Output<ov::Node> clamped =
      std::dynamic_pointer_cast<op::Clamp>(x.get_node_shared_ptr()) && in_low <= 0 && in_high >= 6
          ? x  // behind a ReLU6 there is nothing left to clamp
          : std::make_shared<op::Clamp>(x, in_low, in_high)->output(0);
  const float gain = (out_high - out_low) / (in_high - in_low);
  const float shift = out_low - in_low * gain;
  if (std::abs(gain - 1) < 1e-6F && std::abs(shift) < 1e-6F) {
    return clamped;
  }
  const auto scaled = std::make_shared<op::Multiply>(clamped, op::Constant::create(ov::element::f32, {}, {gain}));
  return std::make_shared<op::Add>(scaled, op::Constant::create(ov::element::f32, {}, {shift}))->output(0);
}

void DropRounding(const std::shared_ptr<ov::Model>& network) {
  for (const std::shared_ptr<ov::Node>& node : network->get_ordered_ops()) {
    if (std::dynamic_pointer_cast<op::FakeQuantize>(node)) {
      if (const auto replacement = WithoutRounding(node)) {
        node->output(0).replace(*replacement);
      }
    }
  }
}

// Lets a fully convolutional network take another input size. What was tied to the published size is freed: pooling
// over the whole grid becomes a mean, resizing to the whole grid follows the size of the new grid.
void Reshape(const std::shared_ptr<ov::Model>& network, const SegmentationModel& model) {
  const bool channels_last = model.input_order == ChannelOrder::kLast;
  const std::shared_ptr<op::Parameter> input = network->get_parameters().at(0);
  const std::size_t row_axis = channels_last ? 1 : 2;
  ov::PartialShape open = input->get_partial_shape();
  if (open[0].is_dynamic()) {
    open[0] = 1;
  }
  if (open[row_axis].is_dynamic() || open[row_axis + 1].is_dynamic()) {  // made for any size: nothing to free
    open[row_axis] = model.input_height;
    open[row_axis + 1] = model.input_width;
    input->set_partial_shape(open);
    network->validate_nodes_and_infer_types();
    return;
  }
  input->set_partial_shape(open);
  const ov::Shape old = open.to_shape();
  ov::Shape shape = old;
  shape[row_axis] = static_cast<std::size_t>(model.input_height);
  shape[row_axis + 1] = static_cast<std::size_t>(model.input_width);
  if (shape == old) {
    return;
  }
  // Cells along an axis (0 = rows, 1 = columns) of the new grid where the old one has `old_cells`.
  const auto cells = [&](std::size_t axis, std::size_t old_cells) {
    const double old_pixels = static_cast<double>(old[row_axis + axis]);
    const auto stride = static_cast<std::size_t>(std::lround(old_pixels / static_cast<double>(old_cells)));
    return static_cast<std::int64_t>((shape[row_axis + axis] - 1) / stride + 1);
  };
  for (const std::shared_ptr<ov::Node>& node : network->get_ordered_ops()) {
    if (const auto pool = std::dynamic_pointer_cast<op::AvgPool>(node)) {
      const ov::Shape from = pool->get_input_shape(0);
      if (pool->get_kernel() == ov::Shape{from[2], from[3]}) {
        const auto axes = op::Constant::create(ov::element::i64, {2}, {2, 3});
        pool->output(0).replace(std::make_shared<op::ReduceMean>(pool->input_value(0), axes, true)->output(0));
      }
    } else if (const auto resize = std::dynamic_pointer_cast<ov::op::v11::Interpolate>(node)) {
      const ov::Shape to = resize->get_output_shape(0);
      const auto size = op::Constant::create(ov::element::i64, {2}, {cells(0, to[1]), cells(1, to[2])});
      resize->input(1).replace_source_output(size);
    }
  }
  input->set_partial_shape(shape);
  network->validate_nodes_and_infer_types();
}

}  // namespace

// (ov::Core::read_model would load the readers of all formats and ask each, which takes longer and lets some of them
// print complaints.)
std::shared_ptr<ov::Model> ReadNetworkFile(const std::string& weights) {
  static const std::map<std::string, std::string> formats = {{".onnx", "onnx"}, {".tflite", "tflite"}, {".xml", "ir"}};
  const auto format = formats.find(std::filesystem::path(weights).extension().string());
  if (format == formats.end()) {
    throw InputError(fmt::format("weights {}: wanted is a file of type .onnx, .tflite, or .xml (OpenVINO)", weights));
  }
  try {
    const ov::frontend::FrontEnd::Ptr reader = ov::frontend::FrontEndManager().load_by_framework(format->second);
    return reader->convert(reader->load(weights));
  } catch (const std::exception& error) {
    throw InputError(fmt::format(
        "weights {}: damaged, cut short, or not a model of type {} ({}); copy it again, or fetch the published ones "
        "with `rds fetch weights`",
        weights, format->first, LastLine(error.what())));  // the lines above are of OpenVINO's own source
  }
}

std::shared_ptr<ov::Model> ReadNetwork(const SegmentationModel& model) {
  std::shared_ptr<ov::Model> network = ReadNetworkFile(model.weights);
  try {
    if (network->inputs().size() != 1 || network->input().get_partial_shape().rank() != 4) {
      throw InputError("wanted is a network with one input of four dimensions");
    }
    const std::vector<std::string> names = OutputNames(model);
    if (names != std::vector<std::string>{""}) {
      network = EndAt(*network, names);
    }
    if (network->outputs().size() != names.size()) {
      throw InputError("the network has several outputs; name one under output.tensor");
    }
    if (model.ignore_rounding) {
      DropRounding(network);
    }
    if (model.input_height > 0) {
      Reshape(network, model);
    }
    const ov::PartialShape shape = network->input().get_partial_shape();
    if (shape.is_dynamic()) {
      throw InputError(fmt::format("the network leaves its input size open ({}); give it under input.size of {}.yaml",
                                   shape.to_string(), model.weights));
    }
  } catch (const std::exception& error) {
    throw InputError(fmt::format("weights {}: {}", model.weights, LastLine(error.what())));
  }
  return network;
}

std::shared_ptr<ov::Model> WithPreprocessing(const ov::Model& network, const SegmentationModel& model, int width,
                                             int height, int batch) {
  ov::preprocess::PrePostProcessor processor(network.clone());
  ov::preprocess::InputInfo& input = processor.input();
  const ov::element::Type wanted = network.input().get_element_type();
  input.tensor()
      .set_element_type(ov::element::u8)
      .set_layout("NHWC")
      .set_shape(ov::PartialShape{1, height, width, 3})
      .set_color_format(ov::preprocess::ColorFormat::BGR);
  if (model.input_is_rgb) {
    input.preprocess().convert_color(ov::preprocess::ColorFormat::RGB);
  }
  input.preprocess().convert_element_type(ov::element::f32).resize(ov::preprocess::ResizeAlgorithm::RESIZE_LINEAR);
  if (model.mean != std::array<float, 3>{0, 0, 0} || model.scale != std::array<float, 3>{1, 1, 1}) {
    input.preprocess()
        .mean(std::vector<float>(model.mean.begin(), model.mean.end()))
        .scale(std::vector<float>(model.scale.begin(), model.scale.end()));
  }
  input.preprocess().convert_element_type(wanted);
  input.model().set_layout(model.input_order == ChannelOrder::kFirst ? "NCHW" : "NHWC");
  for (std::size_t i = 0; i < network.outputs().size(); ++i) {
    processor.output(i).tensor().set_element_type(ov::element::f32);
  }
  std::shared_ptr<ov::Model> whole = processor.build();
  if (batch > 1) {
    ov::set_batch(whole, batch);
  }
  return whole;
}

}  // namespace rds

#endif
