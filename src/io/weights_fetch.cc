// SPDX-License-Identifier: Apache-2.0
#include "io/weights_fetch.h"

#include <spdlog/fmt/fmt.h>

#include <system_error>

#include "base/error.h"
#include "base/sha256.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

std::string ByHand(const PublishedWeights& weights, const fs::path& file, const std::string& url) {
  return fmt::format("To do it by hand: download {} and put it at {} (SHA-256 {}), or name it with --model", url,
                     file.string(), weights.sha256);
}

// Fills FILE.part until it has the size wanted; several tries, each going on where the one before stopped.
void Complete(const PublishedWeights& weights, const std::string& url, const fs::path& part,
              const DownloadProgress& progress) {
  constexpr int kTries = 3;
  std::string problem;
  for (int i = 0; i < kTries; ++i) {
    const DownloadResult result = Download(url, part, weights.bytes, progress);
    if (result.complete) {
      return;
    }
    problem = result.problem;
    if (!result.worth_retrying) {
      break;
    }
  }
  throw InputError(problem);
}

}  // namespace

fs::path FetchWeights(const PublishedWeights& weights, const fs::path& folder, const std::string& url_base,
                      const DownloadProgress& progress) {
  const fs::path file = folder / weights.file;
  const fs::path part = file.string() + ".part";
  const std::string url = url_base + (url_base.ends_with('/') ? "" : "/") + weights.file;
  std::error_code error;
  if (fs::is_regular_file(file, error) && Sha256(file) == weights.sha256) {
    if (progress) {
      progress(weights.bytes, weights.bytes);
    }
    return file;
  }
  fs::create_directories(folder, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot be made ({}); set RDS_CACHE to a folder that you may write to",
                                 folder.string(), error.message()));
  }
  try {
    Complete(weights, url, part, progress);
    if (const std::string digest = Sha256(part); digest != weights.sha256) {
      fs::remove(part, error);
      throw InputError(fmt::format("{}: SHA-256 is {}, not {}; what came is not what was published, and is removed",
                                   url, digest, weights.sha256));
    }
  } catch (const InputError& problem) {
    throw InputError(fmt::format("{}\n  {}", problem.what(), ByHand(weights, file, url)));
  }
  fs::rename(part, file, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot be renamed to {} ({})", part.string(), file.string(), error.message()));
  }
  return file;
}

}  // namespace rds
