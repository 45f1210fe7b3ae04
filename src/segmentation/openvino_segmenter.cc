// SPDX-License-Identifier: Apache-2.0
#include "segmentation/openvino_segmenter.h"

#include "base/error.h"

#ifdef RDS_WITH_OPENVINO

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <openvino/openvino.hpp>
#include <openvino/runtime/exception.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "base/sha256.h"
#include "segmentation/network_output.h"
#include "segmentation/openvino_network.h"
#include "segmentation/weights.h"

namespace rds {
namespace {

std::size_t Area(int width, int height) { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

// A file that was published, whole. Throws InputError for one of such a name that is shorter or damaged.
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
  if (bytes == weights->bytes && Sha256(path) != weights->sha256) {
    throw InputError(
        fmt::format("weights {}: damaged (not the SHA-256 {}); fetch them again with `rds fetch weights {}`", path,
                    weights->sha256, weights->name));
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
      while (count < std::min(rest.size(), MostAtOnce()) && rest[count].image->width == image.width &&
             rest[count].image->height == image.height) {
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
    canceled_ = true;
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

  // Instances of several images cannot be told apart.
  [[nodiscard]] std::size_t MostAtOnce() const {
    return model_.output == SegmentationModel::Output::kInstances ? 1 : static_cast<std::size_t>(options_.max_batch);
  }

  // Runs the network on images of one size. Empty images once canceled.
  std::vector<Image8> Run(std::span<const SegmentationInput> inputs) {
    const int width = inputs[0].image->width;
    const int height = inputs[0].image->height;
    {
      const std::lock_guard lock(mutex_);
      if (canceled_) {
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
    const std::vector<OutputTensor> outputs = OutputsOf(request);
    const MaskThresholds thresholds = ThresholdsOf(model_, options_.threshold, options_.unsure);
    std::vector<Image8> masks;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      masks.push_back(MaskOfOutput(model_, thresholds, outputs, i, network_height_, network_width_, width, height));
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

  // False if canceled.
  bool Infer(ov::InferRequest& request) {
    {
      const std::lock_guard lock(mutex_);
      if (canceled_) {
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
    return finished && !canceled_;
  }

  // What the network gave for the last request.
  static std::vector<OutputTensor> OutputsOf(ov::InferRequest& request) {
    std::vector<OutputTensor> outputs;
    for (std::size_t i = 0; i < request.get_compiled_model().outputs().size(); ++i) {
      const ov::Tensor tensor = request.get_output_tensor(i);
      const ov::Shape shape = tensor.get_shape();
      const auto* const values = tensor.data<float>();
      outputs.push_back({{shape.begin(), shape.end()}, {values, values + tensor.get_size()}});
    }
    return outputs;
  }

  const SegmentationModel model_;
  const OpenVinoOptions options_;
  ov::Core core_;
  std::shared_ptr<ov::Model> network_;  // of Segment's thread, after the constructor
  int network_height_ = 0;
  int network_width_ = 0;
  std::map<Shape, ov::InferRequest> requests_;  // of Segment's thread
  std::mutex mutex_;
  bool canceled_ = false;                // under mutex_
  ov::InferRequest* running_ = nullptr;  // under mutex_
};

}  // namespace

bool HasOpenVino() { return true; }

void CheckOpenVino() {}

std::string OpenVinoVersion() { return ov::get_openvino_version().buildNumber; }

void CheckNetworkFile(const std::string& weights) { std::ignore = ReadNetworkFile(weights); }

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

void CheckNetworkFile(const std::string&) { CheckOpenVino(); }

std::string OpenVinoVersion() { return ""; }

std::unique_ptr<Segmenter> MakeOpenVinoSegmenter(const SegmentationModel&, const OpenVinoOptions&) {
  CheckOpenVino();
  return nullptr;
}

}  // namespace rds

#endif
