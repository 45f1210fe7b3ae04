// SPDX-License-Identifier: Apache-2.0
// The lists of a sequence: which image belongs to which time.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <vector>

#include "io/time_unit.h"

namespace rds {

// An image as rgb.txt, depth.txt and mask.txt list it. Times as written, or in seconds after ToSeconds.
struct ListedImage {
  double timestamp_s = 0;
  std::filesystem::path path;
};

// A pair as associations.txt lists it.
struct ListedPair {
  ListedImage color;
  ListedImage depth;
};

// Rows of "timestamp file". InputError, naming file and line, for an empty list, a malformed row, timestamps that do
// not increase, and a listed image that is not there.
[[nodiscard]] std::vector<ListedImage> ReadImageList(const std::filesystem::path& path);

// Rows with two images, each after its time, in either order and among other columns (ground truth in front or behind):
// the one whose first picture is depth is depth. InputError as above.
[[nodiscard]] std::vector<ListedPair> ReadAssociations(const std::filesystem::path& path);

// The first of the names that is a file in the folder.
[[nodiscard]] std::optional<std::filesystem::path> FindFile(const std::filesystem::path& folder,
                                                            std::initializer_list<const char*> names);

// Whether there is a regular file (or a link to one).
[[nodiscard]] bool IsFile(const std::filesystem::path& path);

}  // namespace rds
