// SPDX-License-Identifier: Apache-2.0
#include "cli/inference_service.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/version.h"
#include "cli/series_json.h"
#include "io/image_io.h"
#include "segmentation/inference_protocol.h"
#include "segmentation/remote_segmenter.h"

namespace rds {
namespace {

using nlohmann::json;

constexpr int kLargestSide_px = 8192;

HttpReply Reply(const json& content, unsigned status = 200) {
  return {.status = status, .body = content.dump(-1, ' ', false, kReplaceBadUtf8)};
}

HttpReply Refuse(unsigned status, const std::string& why) { return Reply({{"error", why}}, status); }

json Metadata(const std::string& name) {
  return {{"name", name},
          {"versions", {"1"}},
          {"platform", kOwnPlatform},
          {"inputs", {{{"name", "image"}, {"datatype", "UINT8"}, {"shape", {-1, -1, -1, 3}}}}},
          {"outputs", {{{"name", "mask"}, {"datatype", "UINT8"}, {"shape", {-1, -1, -1}}}}}};
}

// Raw pixels, RGB, become BGR.
std::vector<Image8> FromPixels(const InferenceTensor& tensor) {
  const std::vector<std::int64_t>& shape = tensor.shape;
  if (shape.size() != 4 || shape[3] != 3) {
    throw InputError("input 'image' of UINT8 has the shape [n, height, width, 3]");
  }
  if (shape[0] > InferenceService::kMostImages || shape[1] < 1 || shape[2] < 1 || shape[1] > kLargestSide_px ||
      shape[2] > kLargestSide_px) {
    throw InputError(fmt::format("at most {} images of at most {} pixels a side are taken",
                                 InferenceService::kMostImages, kLargestSide_px));
  }
  std::vector<Image8> images;
  const char* data = tensor.data.data();
  for (std::int64_t i = 0; i < shape[0]; ++i) {
    Image8& image = images.emplace_back(static_cast<int>(shape[2]), static_cast<int>(shape[1]), 3);
    for (std::size_t p = 0; p < image.data.size(); p += 3, data += 3) {
      image.data[p] = static_cast<std::uint8_t>(data[2]);
      image.data[p + 1] = static_cast<std::uint8_t>(data[1]);
      image.data[p + 2] = static_cast<std::uint8_t>(data[0]);
    }
  }
  return images;
}

std::vector<Image8> FromFiles(const InferenceTensor& tensor) {
  const std::vector<std::string_view> files = StringsOf(tensor);
  if (files.size() > InferenceService::kMostImages) {
    throw InputError(fmt::format("at most {} images are taken", InferenceService::kMostImages));
  }
  std::vector<Image8> images;
  for (const std::string_view file : files) {
    ImageFile image("image", std::string(file));
    if (image.width() > kLargestSide_px || image.height() > kLargestSide_px) {
      throw InputError(fmt::format("images of at most {} pixels a side are taken", kLargestSide_px));
    }
    images.push_back(image.DecodeColor());
  }
  return images;
}

std::vector<Image8> ImagesOf(const HttpRequest& request) {
  const auto length = request.headers.find("inference-header-content-length");
  const InferenceMessage message = DecodeInference(
      request.body, length == request.headers.end() ? std::nullopt : std::optional(ParseLength(length->second)),
      "inputs");
  if (message.tensors.size() != 1 || message.tensors[0].name != "image") {
    throw InputError("one input is wanted, called 'image'");
  }
  const InferenceTensor& tensor = message.tensors[0];
  if (tensor.datatype != "UINT8" && tensor.datatype != "BYTES") {
    throw InputError(fmt::format("input 'image' is UINT8 or BYTES, not {}", tensor.datatype));
  }
  std::vector<Image8> images = tensor.datatype == "BYTES" ? FromFiles(tensor) : FromPixels(tensor);
  if (images.empty() || std::ranges::any_of(images, [&](const Image8& image) {
        return image.width != images[0].width || image.height != images[0].height;
      })) {
    throw InputError("images of one size are wanted, one at least");
  }
  return images;
}

InferenceTensor MaskTensor(const std::vector<Image8>& masks) {
  InferenceTensor tensor{"mask", "UINT8", {std::ssize(masks), masks[0].height, masks[0].width}, {}};
  for (const Image8& mask : masks) {
    tensor.data.append(reinterpret_cast<const char*>(mask.data.data()), mask.data.size());
  }
  return tensor;
}

// Counts one up while it lives.
class Counted {
 public:
  explicit Counted(std::atomic<int>& count) : count_(count), before_(count++) {}
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  [[nodiscard]] int before() const { return before_; }

 private:
  std::atomic<int>& count_;
  const int before_;
};

}  // namespace

InferenceService::InferenceService(std::string name, std::unique_ptr<Segmenter> segmenter, int most_waiting)
    : name_(std::move(name)), most_waiting_(most_waiting), segmenter_(std::move(segmenter)) {}

HttpReply InferenceService::Answer(const HttpRequest& request) {
  const std::string model = "/v2/models/" + name_;
  const bool get = request.method == "GET";
  if (request.target == model + "/infer") {
    return request.method == "POST" ? Infer(request) : Refuse(405, "POST is wanted");
  }
  if (!get) {
    return Refuse(405, "GET is wanted, or POST " + model + "/infer");
  }
  if (request.target == "/v2" || request.target == "/v2/") {
    return Reply({{"name", "rds"}, {"version", kVersion}, {"extensions", {"binary_tensor_data"}}});
  }
  if (request.target == "/v2/health/live") {
    return Reply({{"live", true}});
  }
  if (request.target == "/v2/health/ready") {
    return Reply({{"ready", true}});
  }
  if (request.target == model) {
    return Reply(Metadata(name_));
  }
  if (request.target == model + "/ready") {
    return Reply({{"name", name_}, {"ready", true}});
  }
  return Refuse(404, fmt::format("nothing is at {}; the model is at {}", request.target, model));
}

HttpReply InferenceService::Infer(const HttpRequest& request) {
  const Counted waiting(waiting_);
  if (waiting.before() > most_waiting_) {
    return Refuse(503, fmt::format("busy: {} requests wait already", most_waiting_));
  }
  std::vector<SegmentationInput> inputs;
  try {
    for (Image8& image : ImagesOf(request)) {
      inputs.push_back({FrameId{images_++}, 0, std::make_shared<const Image8>(std::move(image))});
    }
  } catch (const InputError& error) {
    return Refuse(400, error.what());
  }
  std::vector<Image8> masks;
  {
    const std::lock_guard lock(segmenting_);
    masks = segmenter_->Segment(inputs);
  }
  if (masks.size() != inputs.size() || std::ranges::any_of(masks, [](const Image8& mask) { return mask.empty(); })) {
    return Refuse(503, "no answer: the server is ending");
  }
  InferenceBody body = EncodeInference({{"model_name", name_}, {"model_version", "1"}}, "outputs", {MaskTensor(masks)});
  return {.content_type = "application/octet-stream",
          .headers = {{kInferenceHeader, std::to_string(body.json_length)}},
          .body = std::move(body.bytes)};
}

}  // namespace rds
