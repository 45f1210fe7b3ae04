// SPDX-License-Identifier: Apache-2.0
#include "segmentation/remote_segmenter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <regex>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "segmentation/http_connection.h"
#include "segmentation/inference_protocol.h"
#include "segmentation/network_output.h"
#include "segmentation/remote_model.h"
#include "segmentation/segmentation_model.h"

namespace rds {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTries = 3;
constexpr double kFirstPause_s = 0.1;
constexpr double kLongestPause_s = 5;

// What the server says is wrong, or the beginning of whatever it says.
std::string ErrorOf(const HttpResponse& response) {
  const nlohmann::json json = nlohmann::json::parse(response.body, nullptr, false);
  if (json.is_object() && json.contains("error") && json["error"].is_string()) {
    return json["error"].get<std::string>().substr(0, 500);
  }
  return response.body.substr(0, 200);
}

class RemoteSegmenter final : public Segmenter {
 public:
  RemoteSegmenter(const RemoteOptions& options, const std::string& dynamic_classes)
      : options_(options), dynamic_classes_(dynamic_classes), connection_(options.timeout_s) {
    std::smatch match;
    static const std::regex address("https?://[^/ ]+(/[^ ]*)?/v2/models/([^/ ]+)(/versions/[^/ ]+)?/?");
    if (!std::regex_match(options.url, match, address)) {
      throw InputError(
          fmt::format("option semantic.remote.url: '{}' is no address of a model; it reads "
                      "http://HOST:PORT/v2/models/NAME",
                      options.url));
    }
    url_ = options.url.back() == '/' ? options.url.substr(0, options.url.size() - 1) : options.url;
    model_ = DescribeRemoteModel(match[2], options.description);
    described_ = !options.description.empty() || HasBuiltInDescription(match[2]);
    if (described_) {
      ChooseDynamicClasses(model_, dynamic_classes_);
    }
    try {
      HttpConnection impatient(std::min(options.timeout_s, 2.0));  // a server that is not there is not waited for
      ReadMetadata(impatient);
    } catch (const HttpError& error) {
      log::warn("{}; going on without masks until it answers", error.what());
    } catch (const RefusedError& error) {
      throw InputError(error.what());
    }
  }

  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    std::vector<Image8> masks;
    while (masks.size() < inputs.size()) {
      const std::span<const SegmentationInput> rest = inputs.subspan(masks.size());
      if (!WaitUntil(next_try_)) {
        return std::vector<Image8>(inputs.size());
      }
      std::optional<std::vector<Image8>> some = Ask(rest);
      if (!some) {
        return std::vector<Image8>(inputs.size());  // canceled
      }
      for (Image8& mask : *some) {
        masks.push_back(std::move(mask));
      }
    }
    return masks;
  }

  void Cancel() override {
    {
      const std::lock_guard lock(mutex_);
      canceled_ = true;
    }
    cancel_asked_.notify_all();
    connection_.Cancel();
  }

  [[nodiscard]] std::string Name() const override { return "remote, " + url_; }

 private:
  // Masks of the first images; nothing once canceled. Throws what the last try threw.
  std::optional<std::vector<Image8>> Ask(std::span<const SegmentationInput> inputs) {
    double pause_s = kFirstPause_s;
    for (int tried = 1;; ++tried) {
      try {
        if (!info_) {
          ReadMetadata(connection_);
        }
        std::vector<Image8> masks = Infer(inputs);
        if (std::exchange(failures_, 0) > 0) {
          log::info("{}: answers again", url_);
        }
        return masks;
      } catch (const std::exception&) {
        if (Canceled()) {
          return std::nullopt;
        }
        info_.reset();  // it may come back with another model
        bool again = tried < kTries;
        try {
          throw;
        } catch (const HttpError&) {
        } catch (const std::exception&) {
          again = false;
        }
        if (!again) {
          ++failures_;
          const double wait_s = std::min(kLongestPause_s, kFirstPause_s * std::exp2(std::min(failures_, 10)));
          next_try_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait_s));
          throw;
        }
      }
      if (!WaitUntil(Clock::now() +
                     std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause_s)))) {
        return std::nullopt;
      }
      pause_s *= 4;
    }
  }

  void ReadMetadata(HttpConnection& connection) {
    const HttpResponse response = connection.Get(url_);
    if (response.status >= 500) {
      throw HttpError(fmt::format("{}: status {}: {}", url_, response.status, ErrorOf(response)));
    }
    if (response.status != 200) {
      throw RefusedError(fmt::format("{}: status {}: {}", url_, response.status, ErrorOf(response)));
    }
    ModelInfo info = ReadModelInfo(url_, response.body);
    is_own_ = info.platform == kOwnPlatform;
    form_ = FormOf(info, InputModel());
    if (is_own_ && dynamic_classes_ != kDefaultDynamicClass) {
      throw RefusedError("option semantic.dynamic_classes: the server decides; give it to `rds serve`");
    }
    if (!is_own_ && !described_) {
      Guess(info);
    }
    info_ = std::move(info);
  }

  // What images are made into: our own server takes them as they are.
  [[nodiscard]] SegmentationModel InputModel() const { return is_own_ ? SegmentationModel{} : model_; }

  // A model that nobody describes is understood where its output can mean one thing only.
  void Guess(const ModelInfo& info) {
    const std::string& type = info.outputs[0].datatype;
    if (info.outputs.size() != 1 || (type != "UINT8" && type != "BOOL")) {
      throw RefusedError(fmt::format(
          "{}: nothing says what this model gives ({}); describe it in a YAML file (keys as in the comment of "
          "src/segmentation/segmentation_model.h), and name that with semantic.remote.description",
          url_, type));
    }
    model_.output = SegmentationModel::Output::kMask;
    ChooseDynamicClasses(model_, dynamic_classes_);
  }

  std::vector<Image8> Infer(std::span<const SegmentationInput> inputs) {
    const Image8& first = *inputs[0].image;
    std::size_t count = 1;
    if (form_.open_batch && model_.output != SegmentationModel::Output::kInstances) {
      while (count < inputs.size() && inputs[count].image->width == first.width &&
             inputs[count].image->height == first.height) {
        ++count;
      }
    }
    inputs = inputs.first(count);
    nlohmann::json request;
    const std::vector<std::string> wanted = WantedOutputs();
    request["outputs"] = nlohmann::json::array();
    for (const std::string& name : wanted) {
      request["outputs"].push_back({{"name", name}, {"parameters", {{"binary_data", true}}}});
    }
    const InferenceBody body = EncodeInference(std::move(request), "inputs", {InputOf(inputs)});
    const HttpResponse response = connection_.Post(
        url_ + "/infer",
        {{"Content-Type", "application/octet-stream"}, {kInferenceHeader, std::to_string(body.json_length)}},
        body.bytes);
    if (response.status == 503 || response.status == 502 || response.status == 429) {  // busy, or starting
      throw HttpError(fmt::format("{}: status {}: {}", url_, response.status, ErrorOf(response)));
    }
    if (response.status != 200) {
      throw RefusedError(fmt::format("{}: status {}: {}", url_, response.status, ErrorOf(response)));
    }
    return MasksOf(response, wanted, inputs);
  }

  [[nodiscard]] std::vector<std::string> WantedOutputs() const {
    std::vector<std::string> names = is_own_ ? std::vector<std::string>{""} : OutputNames(model_);
    const auto offered = [this](const std::string& name) {
      return std::ranges::any_of(info_->outputs, [&](const TensorInfo& output) { return output.name == name; });
    };
    if (names.size() == 1 && !offered(names[0])) {  // not named, or the server's has another end
      names[0] = info_->outputs[0].name;
    }
    return names;
  }

  [[nodiscard]] InferenceTensor InputOf(std::span<const SegmentationInput> inputs) const {
    const Image8& image = *inputs[0].image;
    InferenceTensor tensor;
    tensor.name = info_->input.name;
    if (form_.has_batch) {
      tensor.shape.push_back(static_cast<std::int64_t>(inputs.size()));
    }
    if (form_.encoding == InputForm::Encoding::kJpeg || (is_own_ && options_.jpeg_quality > 0)) {
      tensor.datatype = "BYTES";
      for (const SegmentationInput& input : inputs) {
        tensor.data += AsBytesElement(AsJpeg(*input.image, options_.jpeg_quality));
      }
      return tensor;
    }
    tensor.datatype = info_->input.datatype;
    const std::int64_t height = form_.height > 0 ? form_.height : image.height;
    const std::int64_t width = form_.width > 0 ? form_.width : image.width;
    const std::array<std::int64_t, 3> shape = form_.order == ChannelOrder::kLast
                                                  ? std::array{height, width, std::int64_t{3}}
                                                  : std::array{std::int64_t{3}, height, width};
    tensor.shape.insert(tensor.shape.end(), shape.begin(), shape.end());
    for (const SegmentationInput& input : inputs) {
      tensor.data += AsPixels(*input.image, form_, InputModel());
    }
    return tensor;
  }

  [[nodiscard]] std::vector<Image8> MasksOf(const HttpResponse& response, const std::vector<std::string>& wanted,
                                            std::span<const SegmentationInput> inputs) const {
    const auto length = response.headers.find("inference-header-content-length");
    const InferenceMessage message = DecodeInference(
        response.body, length == response.headers.end() ? std::nullopt : std::optional(ParseLength(length->second)),
        "outputs");
    const int width = inputs[0].image->width;
    const int height = inputs[0].image->height;
    std::vector<OutputTensor> outputs;
    for (const std::string& name : wanted) {
      const auto found = std::ranges::find(message.tensors, name, &InferenceTensor::name);
      if (found == message.tensors.end()) {
        throw InputError(fmt::format("{}: the answer has no tensor '{}'", url_, name));
      }
      if (is_own_) {
        return OwnMasks(*found, inputs.size(), width, height);
      }
      outputs.push_back({found->shape, FloatsOf(*found)});
    }
    const int network_height = form_.height > 0 ? form_.height : height;
    const int network_width = form_.width > 0 ? form_.width : width;
    std::vector<Image8> masks;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      masks.push_back(
          MaskOfOutput(model_, ThresholdsOf(model_, 0, -1), outputs, i, network_height, network_width, width, height));
    }
    return masks;
  }

  [[nodiscard]] std::vector<Image8> OwnMasks(const InferenceTensor& tensor, std::size_t count, int width,
                                             int height) const {
    const std::vector<std::int64_t> shape = {static_cast<std::int64_t>(count), height, width};
    if (tensor.datatype != "UINT8" || tensor.shape != shape) {
      throw InputError(fmt::format("{}: the masks have another size than the images", url_));
    }
    std::vector<Image8> masks;
    for (std::size_t i = 0; i < count; ++i) {
      Image8& mask = masks.emplace_back(width, height);
      std::memcpy(mask.data.data(), tensor.data.data() + i * mask.data.size(), mask.data.size());
    }
    return masks;
  }

  // False once canceled.
  bool WaitUntil(Clock::time_point due) {
    std::unique_lock lock(mutex_);
    return !cancel_asked_.wait_until(lock, due, [this] { return canceled_; });
  }
  bool Canceled() {
    const std::lock_guard lock(mutex_);
    return canceled_;
  }

  const RemoteOptions options_;
  const std::string dynamic_classes_;
  std::string url_;
  SegmentationModel model_;
  bool described_ = false;  // by a file or built in
  HttpConnection connection_;
  // Of Segment's thread, after the constructor:
  std::optional<ModelInfo> info_;
  InputForm form_;
  bool is_own_ = false;
  int failures_ = 0;  // in a row
  Clock::time_point next_try_{};
  std::mutex mutex_;
  std::condition_variable cancel_asked_;
  bool canceled_ = false;  // under mutex_
};

}  // namespace

std::unique_ptr<Segmenter> MakeRemoteSegmenter(const RemoteOptions& options, const std::string& dynamic_classes) {
  return std::make_unique<RemoteSegmenter>(options, dynamic_classes);
}

}  // namespace rds
