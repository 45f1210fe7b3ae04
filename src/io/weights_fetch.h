// SPDX-License-Identifier: Apache-2.0
// Fetching the published weights, whole or not at all.
#pragma once

#include <filesystem>
#include <string>

#include "io/download.h"
#include "segmentation/weights.h"

namespace rds {

// Downloads `weights` from `url_base`/file into `folder` (made if need be) and returns the file's path. A file that is
// there with the right digest is left as it is; one with another digest is fetched anew. What has arrived lies in
// FILE.part until the digest is found right: an interrupted download goes on from there, in this run (a few times) or
// in a later one. A wrong digest removes the .part. Throws InputError naming URL and file, and how to put the file in
// place by hand. `progress` may be empty.
std::filesystem::path FetchWeights(const PublishedWeights& weights, const std::filesystem::path& folder,
                                   const std::string& url_base, const DownloadProgress& progress);

}  // namespace rds
