#include "semantic/openvino_segmenter.h"

#include "base/error.h"

#ifdef RDS_WITH_OPENVINO

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <openvino/core/preprocess/pre_post_process.hpp>
#include <openvino/frontend/manager.hpp>
#include <openvino/op/interpolate.hpp>
#include <openvino/openvino.hpp>
#include <openvino/opsets/opset8.hpp>
#include <openvino/runtime/exception.hpp>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "semantic/weights.h"

namespace rds {
namespace {

namespace op = ov::opset8;

std::size_t Area(int width, int height) { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

// OpenVINO's errors carry its own source lines; the last line is the one that says something.
std::string LastLine(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \n");
  const std::size_t begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin == std::string::npos ? 0 : begin));
}

// ---- the graph: cut, freed of rounding, reshaped, with pre-processing in front ----

// Makes the tensor called `name` the network's only output, so that what comes after it is not computed.
std::shared_ptr<ov::Model> EndAt(const std::shared_ptr<ov::Model>& network, const std::string& name) {
  const std::shared_ptr<ov::op::v0::Result> result = std::make_shared<ov::op::v0::Result>([&] {
    for (const std::shared_ptr<ov::Node>& node : network->get_ordered_ops()) {
      for (const ov::Output<ov::Node>& output : node->outputs()) {
        if (output.get_names().count(name) > 0) {
          return output;
        }
      }
    }
    throw InputError(fmt::format("output.tensor: the network has no tensor '{}'", name));
  }());
  return std::make_shared<ov::Model>(ov::ResultVector{result}, network->get_parameters());
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
  const ov::Shape old = input->get_shape();
  ov::Shape shape = old;
  const std::size_t row_axis = channels_last ? 1 : 2;
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

// By the format that the file's name says. (ov::Core::read_model would load the readers of all formats and ask each,
// which takes longer and lets some of them print complaints.)
std::shared_ptr<ov::Model> ReadFile(const std::string& weights) {
  static const std::map<std::string, std::string> formats = {{".onnx", "onnx"}, {".tflite", "tflite"}, {".xml", "ir"}};
  const auto format = formats.find(std::filesystem::path(weights).extension().string());
  if (format == formats.end()) {
    throw InputError(fmt::format("weights {}: wanted is a file of type .onnx, .tflite, or .xml (OpenVINO)", weights));
  }
  try {
    const ov::frontend::FrontEnd::Ptr reader = ov::frontend::FrontEndManager().load_by_framework(format->second);
    return reader->convert(reader->load(weights));
  } catch (const std::exception& error) {
    throw InputError(
        fmt::format("weights {}: not readable, perhaps cut short ({}); fetch them again with `rds fetch weights`",
                    weights, LastLine(error.what())));
  }
}

std::shared_ptr<ov::Model> ReadNetwork(const SegmentationModel& model) {
  std::shared_ptr<ov::Model> network = ReadFile(model.weights);
  try {
    if (network->inputs().size() != 1 || network->input().get_partial_shape().rank() != 4) {
      throw InputError("wanted is a network with one input of four dimensions");
    }
    if (!model.output_tensor.empty()) {
      network = EndAt(network, model.output_tensor);
    }
    if (network->outputs().size() != 1) {
      throw InputError("the network has several outputs; name one under output.tensor");
    }
    if (model.ignore_rounding) {
      DropRounding(network);
    }
    if (model.input_height > 0) {
      Reshape(network, model);
    }
    if (network->input().get_partial_shape().is_dynamic()) {
      throw InputError("the network leaves its input size open; give it under input.size");
    }
  } catch (const std::exception& error) {
    throw InputError(fmt::format("weights {}: {}", model.weights, LastLine(error.what())));
  }
  return network;
}

// Puts conversion from recorded BGR images of the given size in front of a copy of the network.
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
  const bool logits = model.output == SegmentationModel::Output::kLogits;
  processor.output().tensor().set_element_type(logits ? ov::element::f32 : ov::element::i32);
  std::shared_ptr<ov::Model> whole = processor.build();
  if (batch > 1) {
    ov::set_batch(whole, batch);
  }
  return whole;
}

// ---- the segmenter ----

// A file of a published name and size. Throws InputError for one of such a name that is shorter.
bool IsPublished(const std::string& path) {
  const PublishedWeights* const weights = FindPublishedWeights(std::filesystem::path(path).filename().string());
  if (weights == nullptr) {
    return false;
  }
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
  if (bytes < weights->bytes) {
    throw InputError(fmt::format("weights {}: cut short ({} of {} bytes); fetch them again with `rds fetch weights {}`",
                                 path, bytes, weights->bytes, weights->name));
  }
  return bytes == weights->bytes;
}

class OpenVinoSegmenter final : public Segmenter {
 public:
  OpenVinoSegmenter(const SegmentationModel& model, const OpenVinoOptions& options) : model_(model), options_(options) {
    if (!IsPublished(model.weights)) {
      Read();
    }
  }

  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    std::vector<Image8> masks;
    while (masks.size() < inputs.size()) {
      const std::span<const SegmentationInput> rest = inputs.subspan(masks.size());
      const Image8& image = *rest[0].image;
      std::size_t count = 1;
      while (count < std::min(rest.size(), static_cast<std::size_t>(options_.max_batch)) &&
             rest[count].image->width == image.width && rest[count].image->height == image.height) {
        ++count;
      }
      for (Image8& mask : Run(rest.first(count))) {
        masks.push_back(std::move(mask));
      }
    }
    return masks;
  }

  void Cancel() override {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    if (running_) {
      running_->cancel();
    }
  }

  [[nodiscard]] std::string Name() const override {
    return "openvino, " + std::filesystem::path(model_.weights).filename().string();
  }

 private:
  using Shape = std::tuple<int, int, int>;  // width, height, batch

  void Read() {
    network_ = ReadNetwork(model_);
    const ov::Shape shape = network_->input().get_shape();
    const bool first = model_.input_order == ChannelOrder::kFirst;
    network_height_ = static_cast<int>(shape[first ? 2 : 1]);
    network_width_ = static_cast<int>(shape[first ? 3 : 2]);
    if (shape[first ? 1 : 3] != 3) {
      throw InputError(fmt::format("weights {}: the input has not three channels under input.layout", model_.weights));
    }
  }

  ov::InferRequest& Request(const Shape& shape) {
    if (!network_) {
      Read();
    }
    const auto known = requests_.find(shape);
    if (known != requests_.end()) {
      return known->second;
    }
    const auto [width, height, batch] = shape;
    // No pinning: inference must not sit on the core that tracking runs on. The precision is the processor's own
    // choice: bf16 where it has that takes half the time, and the masks of the kitchen sequences are as good.
    ov::CompiledModel compiled =
        core_.compile_model(WithPreprocessing(*network_, model_, width, height, batch), options_.device,
                            ov::hint::performance_mode(ov::hint::PerformanceMode::LATENCY),
                            ov::inference_num_threads(options_.threads), ov::hint::enable_cpu_pinning(false));
    return requests_.emplace(shape, compiled.create_infer_request()).first->second;
  }

  // Runs the network on images of one size. Empty images once cancelled.
  std::vector<Image8> Run(std::span<const SegmentationInput> inputs) {
    const int width = inputs[0].image->width;
    const int height = inputs[0].image->height;
    {
      const std::lock_guard lock(mutex_);
      if (cancelled_) {
        return std::vector<Image8>(inputs.size());
      }
    }
    ov::InferRequest& request = Request({width, height, static_cast<int>(inputs.size())});
    std::uint8_t* to = request.get_input_tensor().data<std::uint8_t>();
    for (const SegmentationInput& input : inputs) {
      CopyBgr(*input.image, to);
      to += 3 * Area(width, height);
    }
    if (!Infer(request)) {
      return std::vector<Image8>(inputs.size());
    }
    std::vector<Image8> masks;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      masks.push_back(MaskOf(request.get_output_tensor(), i, width, height));
    }
    return masks;
  }

  static void CopyBgr(const Image8& image, std::uint8_t* to) {
    if (image.channels == 3) {
      std::memcpy(to, image.data.data(), image.data.size());
      return;
    }
    Check(image.channels == 1, "an image has one channel or three");
    for (const std::uint8_t value : image.data) {
      to = std::fill_n(to, 3, value);
    }
  }

  // False if cancelled.
  bool Infer(ov::InferRequest& request) {
    {
      const std::lock_guard lock(mutex_);
      if (cancelled_) {
        return false;
      }
      running_ = &request;
    }
    bool finished = true;
    std::exception_ptr failure;
    try {
      request.infer();
    } catch (const ov::Cancelled&) {
      finished = false;
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    running_ = nullptr;
    if (failure) {
      std::rethrow_exception(failure);
    }
    return finished && !cancelled_;
  }

  Image8 MaskOf(const ov::Tensor& output, std::size_t index, int width, int height) const {
    ov::Shape shape = output.get_shape();
    const std::size_t size = ov::shape_size(shape) / shape[0];
    shape.erase(shape.begin());
    if (model_.output == SegmentationModel::Output::kLabels) {
      shape.erase(std::remove(shape.begin(), shape.end(), 1U), shape.end());
      CheckOutput(shape.size() == 2, "two dimensions of labels");
      const ScoreGrid grid = GridOf(shape[0], shape[1]);
      return MaskFromLabels({output.data<std::int32_t>() + index * size, size}, grid, width, height, model_.labels);
    }
    CheckOutput(shape.size() == 3, "three dimensions of logits");
    const bool first = model_.output_order == ChannelOrder::kFirst;
    const auto classes = static_cast<int>(first ? shape[0] : shape[2]);
    const ScoreGrid grid = GridOf(first ? shape[1] : shape[0], first ? shape[2] : shape[1]);
    CheckOutput(*std::max_element(model_.labels.begin(), model_.labels.end()) < classes, "more classes than labels");
    const std::vector<float> probability =
        ClassProbability({output.data<float>() + index * size, size}, grid.width * grid.height, classes,
                         model_.output_order, model_.labels);
    const double threshold = options_.threshold > 0 ? options_.threshold : model_.threshold;
    return MaskFromProbability(probability, grid, width, height, static_cast<float>(threshold));
  }

  [[nodiscard]] ScoreGrid GridOf(std::size_t height, std::size_t width) const {
    return model_.Grid(network_height_, network_width_, static_cast<int>(height), static_cast<int>(width));
  }

  void CheckOutput(bool condition, const char* wanted) const {
    if (!condition) {
      throw InputError(fmt::format("weights {}: the output has not {}; see the keys under output in {}.yaml",
                                   model_.weights, wanted, model_.weights));
    }
  }

  const SegmentationModel model_;
  const OpenVinoOptions options_;
  ov::Core core_;
  std::shared_ptr<ov::Model> network_;  // of Segment's thread, after the constructor
  int network_height_ = 0;
  int network_width_ = 0;
  std::map<Shape, ov::InferRequest> requests_;  // of Segment's thread
  std::mutex mutex_;
  bool cancelled_ = false;               // under mutex_
  ov::InferRequest* running_ = nullptr;  // under mutex_
};

}  // namespace

bool HasOpenVino() { return true; }

void CheckOpenVino() {}

std::unique_ptr<Segmenter> MakeOpenVinoSegmenter(const SegmentationModel& model, const OpenVinoOptions& options) {
  Check(options.threads >= 1 && options.max_batch >= 1, "inference wants a thread and an image");
  return std::make_unique<OpenVinoSegmenter>(model, options);
}

}  // namespace rds

#else

namespace rds {

bool HasOpenVino() { return false; }

void CheckOpenVino() {
  throw InputError(
      "segmenter 'openvino': this build has no OpenVINO runtime; run scripts/install_openvino.sh, configure and build "
      "again, or choose --segmenter none (no semantics) or stored (masks of the sequence)");
}

std::unique_ptr<Segmenter> MakeOpenVinoSegmenter(const SegmentationModel&, const OpenVinoOptions&) {
  CheckOpenVino();
  return nullptr;
}

}  // namespace rds

#endif
