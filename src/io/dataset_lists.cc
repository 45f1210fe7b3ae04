// SPDX-License-Identifier: Apache-2.0
#include "io/dataset_lists.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <string>

#include "base/error.h"
#include "io/image_io.h"
#include "io/text_table.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

ListedImage ParseImage(const TextTable& table, const TextRow& row, std::size_t column, const fs::path& folder) {
  ListedImage image{table.Number(row, column, "timestamp"), folder / row.fields[column + 1]};
  if (!IsFile(image.path)) {
    throw InputError(fmt::format("{}: image {} is not there", table.Where(row), image.path.string()));
  }
  return image;
}

void CheckIncreasing(const TextTable& table, const TextRow& row, double before_s, double timestamp_s) {
  if (!(timestamp_s > before_s)) {
    throw InputError(fmt::format("{}: timestamp {:.6f} does not come after the one of the row above, {:.6f}",
                                 table.Where(row), timestamp_s, before_s));
  }
}

TextTable ReadList(const fs::path& path, std::size_t columns, const char* form) {
  TextTable table = ReadTextTable(path);
  for (const TextRow& row : table.rows) {
    if (row.fields.size() < columns) {
      throw InputError(fmt::format("{}: {} columns; '{}' is wanted", table.Where(row), row.fields.size(), form));
    }
  }
  if (table.rows.empty()) {
    throw InputError(path.string() + ": no images are listed in it");
  }
  return table;
}

// Columns of the two times; a file stands after each. By the words that are no numbers, if there are two.
std::array<std::size_t, 2> TimeColumns(const TextRow& row) {
  std::vector<std::size_t> files;
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    if (!ParseNumber(row.fields[i])) {
      files.push_back(i);
    }
  }
  const bool clear = files.size() == 2 && files[0] >= 1 && files[1] >= files[0] + 2;
  return clear ? std::array{files[0] - 1, files[1] - 1} : std::array<std::size_t, 2>{0, 2};
}

// Whether the picture is a depth image; nothing if it cannot be told.
std::optional<bool> IsDepth(const fs::path& path) {
  try {
    return ImageFile(path).MayBeDepth();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

bool DepthComesFirst(const ListedImage& first, const ListedImage& second) {
  const std::optional<bool> first_is = IsDepth(first.path);
  const std::optional<bool> second_is = IsDepth(second.path);
  if (first_is && second_is && *first_is != *second_is) {
    return *first_is;
  }
  const auto named_depth = [](const ListedImage& image) {
    return image.path.parent_path().filename().string().find("depth") != std::string::npos;
  };
  return named_depth(first) && !named_depth(second);
}

}  // namespace

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::vector<ListedImage> ReadImageList(const fs::path& path) {
  const TextTable table = ReadList(path, 2, "timestamp file");
  std::vector<ListedImage> images;
  images.reserve(table.rows.size());
  for (const TextRow& row : table.rows) {
    images.push_back(ParseImage(table, row, 0, path.parent_path()));
    if (images.size() > 1) {
      CheckIncreasing(table, row, images[images.size() - 2].timestamp_s, images.back().timestamp_s);
    }
  }
  return images;
}

std::vector<ListedPair> ReadAssociations(const fs::path& path) {
  const TextTable table = ReadList(path, 4, "timestamp color-file timestamp depth-file");
  const auto [first, second] = TimeColumns(table.rows.front());
  std::vector<ListedPair> pairs;
  pairs.reserve(table.rows.size());
  bool depth_first = false;
  for (const TextRow& row : table.rows) {
    if (row.fields.size() < second + 2) {
      throw InputError(fmt::format("{}: {} columns, fewer than the rows above", table.Where(row), row.fields.size()));
    }
    ListedImage one = ParseImage(table, row, first, path.parent_path());
    ListedImage other = ParseImage(table, row, second, path.parent_path());
    if (pairs.empty()) {
      depth_first = DepthComesFirst(one, other);
    }
    if (depth_first) {
      std::swap(one, other);
    }
    if (!pairs.empty()) {
      CheckIncreasing(table, row, pairs.back().color.timestamp_s, one.timestamp_s);
    }
    pairs.push_back({std::move(one), std::move(other)});
  }
  return pairs;
}

std::optional<fs::path> FindFile(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (IsFile(folder / name)) {
      return folder / name;
    }
  }
  return std::nullopt;
}

}  // namespace rds
