// SPDX-License-Identifier: Apache-2.0
// The published weights: where they come from and where they are kept (io/weights_fetch.h fetches them).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace rds {

// One file that its publisher offers, named by commit and digest, so that it is the same bytes for ever.
struct PublishedWeights {
  const char* name;    // as in `rds fetch weights NAME`
  const char* file;    // name of the file, at the publisher's and in the cache
  std::int64_t bytes;  // size of the file
  const char* sha256;  // hexadecimal
  const char* about;   // for people
};

// "fast" and "accurate": DeepLabV3 with MobileNetV2 by Google, Apache-2.0, quantized, 21 classes of PASCAL VOC.
[[nodiscard]] std::span<const PublishedWeights> AllPublishedWeights();

// The one of that name ("fast", "accurate"), or of that file name; null if there is none.
[[nodiscard]] const PublishedWeights* FindPublishedWeights(const std::string& name);

// The publisher's folder, by commit. The environment variable RDS_WEIGHTS_URL names a mirror instead.
[[nodiscard]] std::string WeightsUrl();

// Where fetched files are kept: $RDS_CACHE, else $XDG_CACHE_HOME/rds, else ~/.cache/rds. Throws InputError if none of
// RDS_CACHE, XDG_CACHE_HOME and HOME is set.
[[nodiscard]] std::filesystem::path CacheFolder();

}  // namespace rds
