// SPDX-License-Identifier: Apache-2.0
#include "segmentation/remote_model.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>

#include "base/error.h"

namespace rds {
namespace {

TensorInfo ReadTensorInfo(const nlohmann::json& json) {
  return {json.at("name").get<std::string>(), json.at("datatype").get<std::string>(),
          json.at("shape").get<std::vector<std::int64_t>>()};
}

cv::Mat ColorMat(const Image8& image) {
  const cv::Mat view(image.height, image.width, CV_MAKETYPE(CV_8U, image.channels),
                     const_cast<std::uint8_t*>(image.data.data()));
  cv::Mat color;
  if (image.channels == 1) {
    cv::cvtColor(view, color, cv::COLOR_GRAY2BGR);
  } else {
    color = view;
  }
  return color;
}

}  // namespace

ModelInfo ReadModelInfo(const std::string& url, const std::string& body) {
  try {
    const nlohmann::json json = nlohmann::json::parse(body);
    ModelInfo info{json.value("platform", ""), {}, {}};
    if (json.at("inputs").size() != 1 || json.at("outputs").empty()) {
      throw RefusedError(url + ": a model with one input and an output is wanted");
    }
    info.input = ReadTensorInfo(json["inputs"][0]);
    for (const nlohmann::json& output : json["outputs"]) {
      info.outputs.push_back(ReadTensorInfo(output));
    }
    return info;
  } catch (const nlohmann::json::exception& error) {
    throw RefusedError(fmt::format("{}: this is no model's metadata ({})", url, error.what()));
  }
}

InputForm FormOf(const ModelInfo& info, const SegmentationModel& model) {
  const TensorInfo& input = info.input;
  InputForm form;
  if (input.datatype == "BYTES") {
    form.encoding = InputForm::Encoding::kJpeg;
    form.has_batch = !input.shape.empty();
    form.open_batch = form.has_batch && input.shape[0] < 0;
    return form;
  }
  const std::size_t rank = input.shape.size();
  if ((input.datatype != "UINT8" && input.datatype != "FP32") || (rank != 3 && rank != 4)) {
    throw RefusedError(fmt::format("model {} wants {} of shape [{}]; BYTES, UINT8 or FP32 images are sent", input.name,
                                   input.datatype, fmt::join(input.shape, ", ")));
  }
  form.encoding = input.datatype == "UINT8" ? InputForm::Encoding::kBytes : InputForm::Encoding::kFloats;
  form.has_batch = rank == 4;
  form.open_batch = rank == 4 && input.shape[0] < 0;
  const std::span<const std::int64_t> image = std::span(input.shape).last(3);
  if (image[0] != 3 && image[2] != 3) {
    throw RefusedError(fmt::format("model {} does not want three channels", input.name));
  }
  form.order = image[2] == 3 ? ChannelOrder::kLast : ChannelOrder::kFirst;
  const std::size_t rows = form.order == ChannelOrder::kLast ? 0 : 1;
  const auto size = [](std::int64_t wanted, int described) {
    return wanted > 0 && wanted <= 16384 ? static_cast<int>(wanted) : described;
  };
  form.height = size(image[rows], model.input_height);
  form.width = size(image[rows + 1], model.input_width);
  return form;
}

std::string AsJpeg(const Image8& image, int quality) {
  std::vector<std::uint8_t> bytes;
  Check(cv::imencode(".jpg", ColorMat(image), bytes, {cv::IMWRITE_JPEG_QUALITY, quality > 0 ? quality : 95}),
        "a JPEG can be encoded");
  return {bytes.begin(), bytes.end()};
}

std::string AsPixels(const Image8& image, const InputForm& form, const SegmentationModel& model) {
  cv::Mat color = ColorMat(image);
  if (model.input_is_rgb) {
    cv::Mat rgb;
    cv::cvtColor(color, rgb, cv::COLOR_BGR2RGB);
    color = rgb;
  }
  const cv::Size size(form.width > 0 ? form.width : image.width, form.height > 0 ? form.height : image.height);
  const bool floats = form.encoding == InputForm::Encoding::kFloats;
  cv::Mat pixels;
  color.convertTo(pixels, floats ? CV_32F : CV_8U);
  if (pixels.size() != size) {
    cv::Mat resized;
    cv::resize(pixels, resized, size, 0, 0, cv::INTER_LINEAR);
    pixels = resized;
  }
  if (floats) {
    const cv::Scalar mean(model.mean[0], model.mean[1], model.mean[2]);
    const cv::Scalar scale(1.0 / model.scale[0], 1.0 / model.scale[1], 1.0 / model.scale[2]);
    cv::subtract(pixels, mean, pixels);
    cv::multiply(pixels, scale, pixels);
  }
  std::string bytes;
  const auto append = [&bytes](const cv::Mat& mat) {
    bytes.append(reinterpret_cast<const char*>(mat.data), mat.total() * mat.elemSize());
  };
  if (form.order == ChannelOrder::kLast) {
    append(pixels.isContinuous() ? pixels : pixels.clone());
  } else {
    std::vector<cv::Mat> channels;
    cv::split(pixels, channels);
    std::ranges::for_each(channels, append);
  }
  return bytes;
}

}  // namespace rds
