// SPDX-License-Identifier: Apache-2.0
// What a server says of its model, and images as that model wants them.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/image.h"
#include "segmentation/segmentation_model.h"

namespace rds {

// The server answers, but not with what is wanted: asking again at once is of no use.
class RefusedError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A tensor as the server's metadata tells of it; -1 in the shape: any size.
struct TensorInfo {
  std::string name;
  std::string datatype;
  std::vector<std::int64_t> shape;
};

struct ModelInfo {
  std::string platform;
  TensorInfo input;
  std::vector<TensorInfo> outputs;
};

// From the metadata that the server at `url` gave. Throws RefusedError for what is no model with one input.
[[nodiscard]] ModelInfo ReadModelInfo(const std::string& url, const std::string& body);

// How images go into the input.
struct InputForm {
  enum class Encoding { kJpeg, kBytes, kFloats } encoding = Encoding::kBytes;
  bool has_batch = true;
  bool open_batch = false;
  ChannelOrder order = ChannelOrder::kLast;
  int height = 0;  // 0 = the image's
  int width = 0;
};

// Throws RefusedError for an input that takes no images.
[[nodiscard]] InputForm FormOf(const ModelInfo& info, const SegmentationModel& model);

// `quality` 0: a good one.
[[nodiscard]] std::string AsJpeg(const Image8& image, int quality);

// The pixels as the network wants them, in its order: resized, and for floats made what `model` says.
[[nodiscard]] std::string AsPixels(const Image8& image, const InputForm& form, const SegmentationModel& model);

}  // namespace rds
