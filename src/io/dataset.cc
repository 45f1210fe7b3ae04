#include "io/dataset.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "io/dataset_association.h"
#include "io/image_io.h"
#include "io/text_table.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// An image as rgb.txt, depth.txt and mask.txt list it.
struct ListedImage {
  double timestamp_s = 0;
  fs::path path;
};

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

std::vector<double> TimesOf(const std::vector<ListedImage>& images) {
  std::vector<double> times;
  times.reserve(images.size());
  for (const ListedImage& image : images) {
    times.push_back(image.timestamp_s);
  }
  return times;
}

// Rows of "timestamp colour timestamp depth", in either order: associate.py writes what it is given first.
std::vector<DatasetFrame> ReadAssociations(const fs::path& path) {
  const TextTable table = ReadList(path, 4, "timestamp colour-file timestamp depth-file");
  const bool depth_first = table.rows.front().fields[1].starts_with("depth");
  std::vector<DatasetFrame> frames;
  frames.reserve(table.rows.size());
  for (const TextRow& row : table.rows) {
    const ListedImage color = ParseImage(table, row, depth_first ? 2 : 0, path.parent_path());
    const ListedImage depth = ParseImage(table, row, depth_first ? 0 : 2, path.parent_path());
    if (!frames.empty()) {
      CheckIncreasing(table, row, frames.back().timestamp_s, color.timestamp_s);
    }
    frames.push_back({color.timestamp_s, depth.timestamp_s, color.path, depth.path, {}});
  }
  return frames;
}

// The first of the names that is there.
std::optional<fs::path> FindFile(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (IsFile(folder / name)) {
      return folder / name;
    }
  }
  return std::nullopt;
}

std::vector<DatasetFrame> AssociateLists(const fs::path& folder, double max_difference_s, std::size_t& listed) {
  for (const char* name : {"rgb.txt", "depth.txt"}) {
    if (!IsFile(folder / name)) {
      throw InputError(
          fmt::format("{}: no {} in it; a sequence is a folder with rgb.txt and depth.txt, or with "
                      "associations.txt (TUM RGB-D layout)",
                      folder.string(), name));
    }
  }
  const std::vector<ListedImage> color = ReadImageList(folder / "rgb.txt");
  const std::vector<ListedImage> depth = ReadImageList(folder / "depth.txt");
  listed = color.size();
  std::vector<DatasetFrame> frames;
  frames.reserve(color.size());
  for (const auto& [c, d] : AssociateByTime(TimesOf(color), TimesOf(depth), max_difference_s)) {
    frames.push_back({color[c].timestamp_s, depth[d].timestamp_s, color[c].path, depth[d].path, {}});
  }
  if (frames.empty()) {
    throw InputError(
        fmt::format("{}: no depth image within {} s of any colour image; rgb.txt begins at {:.6f}, "
                    "depth.txt at {:.6f}: are both of one clock?",
                    folder.string(), max_difference_s, color.front().timestamp_s, depth.front().timestamp_s));
  }
  return frames;
}

void AttachMasks(const fs::path& list, double max_difference_s, std::vector<DatasetFrame>& frames) {
  const std::vector<ListedImage> masks = ReadImageList(list);
  std::vector<double> times;
  times.reserve(frames.size());
  for (const DatasetFrame& frame : frames) {
    times.push_back(frame.timestamp_s);
  }
  for (const auto& [f, m] : AssociateByTime(times, TimesOf(masks), max_difference_s)) {
    frames[f].mask_path = masks[m].path;
  }
}

// Cuts the range out; InputError if it does not fit.
void Select(const FrameRange& range, const fs::path& folder, std::vector<DatasetFrame>& frames) {
  const std::size_t end = range.end.value_or(frames.size());
  if (end > frames.size() || range.begin >= end) {
    throw InputError(fmt::format("{}: frames {}:{} asked for, the sequence has 0:{}", folder.string(), range.begin,
                                 range.end ? std::to_string(end) : "", frames.size()));
  }
  frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(end), frames.end());
  frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(range.begin));
}

void CheckSize(const fs::path& path, int width, int height, const PinholeCamera& camera) {
  if (width != camera.width || height != camera.height) {
    throw InputError(
        fmt::format("{}: {} x {} pixels, the camera has {} x {}; give the camera of this sequence (--camera)",
                    path.string(), width, height, camera.width, camera.height));
  }
}

std::optional<std::size_t> ParseIndex(const std::string& text) {
  std::size_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && stop == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

FrameRange ParseFrameRange(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string first = text.substr(0, colon);
  const std::string last = colon == std::string::npos ? "" : text.substr(colon + 1);
  const std::optional<std::size_t> begin = first.empty() ? 0 : ParseIndex(first);
  const std::optional<std::size_t> end = ParseIndex(last);
  if (colon == std::string::npos || !begin || (!last.empty() && !end) || (end && *end <= *begin)) {
    throw InputError("frames '" + text +
                     "': A:B is wanted, with A below B, for frames A, A + 1, ..., B - 1 (A: and :B work too)");
  }
  return {*begin, end};
}

Dataset Dataset::Open(const fs::path& folder, const DatasetOptions& options) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError(
        fmt::format("{}: {}", folder.string(),
                    error ? "no such sequence folder: " + error.message() : "a file, not a sequence folder"));
  }
  Dataset dataset;
  dataset.folder_ = folder;
  dataset.options_ = options;
  if (const auto associations = FindFile(folder, {"associations.txt", "associate.txt"})) {
    dataset.frames_ = ReadAssociations(*associations);
    dataset.listed_color_images_ = dataset.frames_.size();
  } else {
    dataset.frames_ = AssociateLists(folder, options.max_difference_s, dataset.listed_color_images_);
  }
  dataset.color_images_without_depth_ = dataset.listed_color_images_ - dataset.frames_.size();
  if (const auto list = FindFile(folder, {"mask.txt"})) {
    AttachMasks(*list, options.max_difference_s, dataset.frames_);
    dataset.has_masks_ = true;
  }
  if (const auto truth = FindFile(folder, {"groundtruth.txt"})) {
    dataset.ground_truth_ = ReadTrajectory(*truth);
  }
  dataset.all_frames_ = dataset.frames_.size();
  dataset.first_frame_ = options.frames.begin;
  Select(options.frames, folder, dataset.frames_);
  return dataset;
}

std::string Dataset::Name() const {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(folder_, error);
  const fs::path& path = error ? folder_ : canonical;
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

std::string Dataset::Summary() const {
  std::string text = fmt::format("{}: {} frames", Name(), frames_.size());
  if (frames_.size() != all_frames_) {
    text += fmt::format(" ({}:{} of {})", first_frame_, first_frame_ + frames_.size(), all_frames_);
  }
  if (color_images_without_depth_ > 0) {
    text += fmt::format("; {} of {} colour images have no depth image within {} s and are left out",
                        color_images_without_depth_, listed_color_images_, options_.max_difference_s);
  }
  return text;
}

RgbdFrame Dataset::Load(std::size_t index, const PinholeCamera& camera) const {
  const DatasetFrame& frame = frames_.at(index);
  Image8 color = ReadColor(frame.color_path);
  Image16 depth = ReadDepth(frame.depth_path);
  if (color.width != depth.width || color.height != depth.height) {
    throw InputError(fmt::format(
        "{}: {} x {} pixels, its colour image {} has {} x {}; depth registered to colour is "
        "wanted",
        frame.depth_path.string(), depth.width, depth.height, frame.color_path.string(), color.width, color.height));
  }
  CheckSize(frame.color_path, color.width, color.height, camera);
  return {frame.timestamp_s, std::make_shared<const Image8>(std::move(color)),
          std::make_shared<const Image16>(std::move(depth))};
}

Image8 Dataset::LoadColor(std::size_t index) const { return ReadColor(frames_.at(index).color_path); }

Image16 Dataset::LoadDepth(std::size_t index) const { return ReadDepth(frames_.at(index).depth_path); }

std::optional<Image8> Dataset::LoadMask(std::size_t index, const PinholeCamera& camera) const {
  const fs::path& path = frames_.at(index).mask_path;
  if (path.empty()) {
    return std::nullopt;
  }
  Image8 mask = ReadMask(path);
  CheckSize(path, mask.width, mask.height, camera);
  return mask;
}

}  // namespace rds
