// SPDX-License-Identifier: Apache-2.0
#include "segmentation/segmenter_factory.h"

#include <spdlog/fmt/fmt.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "base/error.h"
#include "base/suggest.h"
#include "segmentation/remote_segmenter.h"
#include "segmentation/segmentation_model.h"
#include "segmentation/unsure_segmenter.h"
#include "segmentation/weights.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWaysOut =
    "fetch the published ones with `rds fetch weights`, name a file with --model, or choose --segmenter geometry (what "
    "moves, without a network), --segmenter none (no semantics) or stored (masks of the sequence)";

bool IsFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

std::string FromCache(const PublishedWeights& weights) {
  const fs::path file = CacheFolder() / weights.file;
  if (!IsFile(file)) {
    throw InputError(fmt::format("weights '{}' are not in {}; run `rds fetch weights {}`", weights.name,
                                 CacheFolder().string(), weights.name));
  }
  return file.string();
}

std::string FromName(const std::string& name) {
  if (const PublishedWeights* const weights = FindPublishedWeights(name); weights != nullptr && !IsFile(name)) {
    return FromCache(*weights);
  }
  if (!IsFile(name)) {
    throw InputError(fmt::format("weights {}: no such file; {}", name, kWaysOut));
  }
  return name;
}

}  // namespace

const std::vector<std::string>& SegmenterNames() {
  static const std::vector<std::string> names = {"openvino", "remote", "stored", "geometry", "none"};
  return names;
}

std::string ResolveWeights(const std::string& model) {
  if (!model.empty()) {
    return FromName(model);
  }
  if (const char* const given = std::getenv("RDS_WEIGHTS"); given != nullptr && *given != '\0') {  // NOLINT
    return FromName(given);
  }
  for (const PublishedWeights& weights : AllPublishedWeights()) {
    if (const fs::path file = CacheFolder() / weights.file; IsFile(file)) {
      return file.string();
    }
  }
  throw InputError(fmt::format("segmenter 'openvino': no weights in {}; {}", CacheFolder().string(), kWaysOut));
}

std::unique_ptr<Segmenter> MakeSegmenter(const std::string& name, const SegmenterOptions& options,
                                         std::vector<StoredMask> masks, MaskReader mask_reader) {
  if (name == "none") {
    return nullptr;
  }
  if (name == "geometry") {
    return std::make_unique<UnsureSegmenter>();
  }
  if (name == "stored") {
    return std::make_unique<StoredSegmenter>(std::move(masks), std::move(mask_reader), options.stored_delay_ms);
  }
  if (name == "remote") {
    return MakeRemoteSegmenter(options.remote, options.dynamic_classes);
  }
  if (name == "openvino") {
    CheckOpenVino();  // before the weights: without the runtime they are of no use
    const std::string weights = ResolveWeights(options.model);
    if (!HasDescription(weights)) {
      CheckNetworkFile(weights);  // that it is damaged is said first, not that nothing describes it
    }
    SegmentationModel model = LoadSegmentationModel(weights);
    ChooseDynamicClasses(model, options.dynamic_classes);
    return MakeOpenVinoSegmenter(model, options.openvino);
  }
  throw InputError(fmt::format("--segmenter: '{}' is unknown{}; one of {}", name, Suggestion(name, SegmenterNames()),
                               fmt::join(SegmenterNames(), ", ")));
}

}  // namespace rds
