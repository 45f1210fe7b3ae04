// SPDX-License-Identifier: Apache-2.0
#include "segmentation/weights.h"

#include <array>
#include <cstdlib>

#include "base/error.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPublisher =
    "https://raw.githubusercontent.com/google-coral/test_data/104342d2d3480b3e66203073dac24f4e2dbb4c41";

constexpr std::array<PublishedWeights, 2> kPublished = {{
    {"accurate", "deeplabv3_mnv2_pascal_quant.tflite", 2'193'224,
     "350af47fd346ea6d74b58833a351f583ba860e9806ec5bd292ff8d8f1f249398", "people's outlines followed closely"},
    {"fast", "deeplabv3_mnv2_dm05_pascal_quant.tflite", 760'904,
     "0470d2a782aa54eeeb99d32e7b6b3fb7722905c7c4f5d26bd957ec861366d48b", "half the time, misses more of them"},
}};

std::string Environment(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets variables
  return value != nullptr ? value : "";
}

}  // namespace

std::span<const PublishedWeights> AllPublishedWeights() { return kPublished; }

const PublishedWeights* FindPublishedWeights(const std::string& name) {
  for (const PublishedWeights& weights : kPublished) {
    if (name == weights.name || name == weights.file) {
      return &weights;
    }
  }
  return nullptr;
}

std::string WeightsUrl() {
  const std::string mirror = Environment("RDS_WEIGHTS_URL");
  return mirror.empty() ? kPublisher : mirror;
}

fs::path CacheFolder() {
  if (const std::string folder = Environment("RDS_CACHE"); !folder.empty()) {
    return folder;
  }
  if (const std::string folder = Environment("XDG_CACHE_HOME"); !folder.empty()) {
    return fs::path(folder) / "rds";
  }
  if (const std::string home = Environment("HOME"); !home.empty()) {
    return fs::path(home) / ".cache" / "rds";
  }
  throw InputError("no cache folder: set RDS_CACHE to a folder (XDG_CACHE_HOME and HOME are not set either)");
}

}  // namespace rds
