// SPDX-License-Identifier: Apache-2.0
#include "io/dataset.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/log.h"
#include "io/dataset_association.h"
#include "io/dataset_lists.h"
#include "io/image_io.h"
#include "io/time_unit.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

std::vector<double> TimesOf(const std::vector<ListedImage>& images) {
  std::vector<double> times;
  times.reserve(images.size());
  for (const ListedImage& image : images) {
    times.push_back(image.timestamp_s);
  }
  return times;
}

std::vector<double> TimesOf(const std::vector<DatasetFrame>& frames) {
  std::vector<double> times;
  times.reserve(frames.size());
  for (const DatasetFrame& frame : frames) {
    times.push_back(frame.timestamp_s);
  }
  return times;
}

// The unit of a sequence's times, by its color images: they come one after the other, which masks need not. Says so
// where it is not seconds.
TimeUnit UnitOf(const fs::path& list, const std::vector<ListedImage>& color) {
  const TimeUnit unit = GuessTimeUnit(TimesOf(color), false);
  if (unit == TimeUnit::kFrames) {
    log::info("{}: times are frame numbers; {:g} frames a second are assumed", list.string(), kFrameNumberRate_hz);
  } else if (unit != TimeUnit::kSeconds) {
    log::info("{}: times are {}; results are in seconds", list.string(), NameOf(unit));
  }
  return unit;
}

void ToSeconds(TimeUnit unit, std::vector<ListedImage>& images) {
  for (ListedImage& image : images) {
    image.timestamp_s *= SecondsIn(unit);
  }
}

std::vector<DatasetFrame> FramesOfPairs(const fs::path& list, TimeUnit& unit) {
  std::vector<ListedImage> color;
  std::vector<ListedImage> depth;
  for (ListedPair& pair : ReadAssociations(list)) {
    color.push_back(std::move(pair.color));
    depth.push_back(std::move(pair.depth));
  }
  unit = UnitOf(list, color);
  ToSeconds(unit, color);
  ToSeconds(unit, depth);
  std::vector<DatasetFrame> frames;
  frames.reserve(color.size());
  for (std::size_t i = 0; i < color.size(); ++i) {
    frames.push_back({color[i].timestamp_s, depth[i].timestamp_s, color[i].path, depth[i].path, {}});
  }
  return frames;
}

fs::path NeedList(const fs::path& folder, std::initializer_list<const char*> names) {
  if (auto list = FindFile(folder, names)) {
    return *list;
  }
  throw InputError(fmt::format(
      "{}: no {} in it; a sequence is a folder with rgb.txt and depth.txt (or color.txt, aligned_depth.txt), "
      "or with associations.txt (TUM RGB-D layout)",
      folder.string(), *names.begin()));
}

std::vector<DatasetFrame> AssociateLists(const fs::path& folder, double max_difference_s, std::size_t& listed,
                                         TimeUnit& unit) {
  const fs::path color_list = NeedList(folder, {"rgb.txt", "color.txt"});
  const fs::path depth_list = NeedList(folder, {"depth.txt", "aligned_depth.txt"});
  std::vector<ListedImage> color = ReadImageList(color_list);
  std::vector<ListedImage> depth = ReadImageList(depth_list);
  unit = UnitOf(color_list, color);
  ToSeconds(unit, color);
  ToSeconds(unit, depth);
  listed = color.size();
  std::vector<DatasetFrame> frames;
  frames.reserve(color.size());
  for (const auto& [c, d] : AssociateByTime(TimesOf(color), TimesOf(depth), max_difference_s)) {
    frames.push_back({color[c].timestamp_s, depth[d].timestamp_s, color[c].path, depth[d].path, {}});
  }
  if (frames.empty()) {
    throw InputError(
        fmt::format("{}: no depth image within {} s of any color image; {} begins at {:.6f}, "
                    "{} at {:.6f}: are both of one clock?",
                    folder.string(), max_difference_s, color_list.filename().string(), color.front().timestamp_s,
                    depth_list.filename().string(), depth.front().timestamp_s));
  }
  return frames;
}

// Whether a mask.txt was written by `rds segment`.
bool IsSegmented(const fs::path& list) { return ReadFile(list).starts_with(kSegmentedMasks); }

void AttachMasks(const fs::path& list, TimeUnit unit, bool unsure, double max_difference_s,
                 std::vector<DatasetFrame>& frames) {
  std::vector<ListedImage> masks = ReadImageList(list);
  if (!unsure) {
    ToSeconds(unit, masks);
  }
  for (const auto& [f, m] : AssociateByTime(TimesOf(frames), TimesOf(masks), max_difference_s)) {
    frames[f].mask_path = masks[m].path;
  }
}

// Runs what reads a file that the run does not need: what is wrong with it is said, and ends nothing.
template <typename Function>
bool IfUsable(const char* without, Function&& read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    log::warn("{}; going on without {}", error.what(), without);
    return false;
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

// Before anything is decoded: a header may claim any size.
void CheckSize(const ImageFile& image, const PinholeCamera& camera) {
  if (image.width() != camera.width || image.height() != camera.height) {
    throw InputError(
        fmt::format("{}: {} x {} pixels, the camera has {} x {}; give the camera of this sequence (--camera)",
                    image.path().string(), image.width(), image.height(), camera.width, camera.height));
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
  TimeUnit unit = TimeUnit::kSeconds;
  if (const auto associations =
          FindFile(folder, {"associations.txt", "associate.txt", "association.txt", "associated.txt"})) {
    dataset.frames_ = FramesOfPairs(*associations, unit);
    dataset.listed_color_images_ = dataset.frames_.size();
  } else {
    dataset.frames_ = AssociateLists(folder, options.max_difference_s, dataset.listed_color_images_, unit);
  }
  dataset.color_images_without_depth_ = dataset.listed_color_images_ - dataset.frames_.size();
  const fs::path masks = options.masks.empty() ? folder : options.masks;
  const auto list = FindFile(masks, {"mask.txt"});
  if (!list && !options.masks.empty()) {
    throw InputError(masks.string() + ": no mask.txt in it; `rds segment` writes one");
  }
  if (list) {
    const auto attach = [&] {
      dataset.masks_have_unsure_ = IsSegmented(*list);
      AttachMasks(*list, unit, dataset.masks_have_unsure_, options.max_difference_s, dataset.frames_);
    };
    if (options.needs_masks) {
      attach();
      dataset.has_masks_ = true;
    } else {
      dataset.has_masks_ = IfUsable("masks", attach);
    }
  }
  if (const auto truth = FindFile(folder, {"groundtruth.txt"})) {
    IfUsable("ground truth", [&] { dataset.ground_truth_ = ReadTrajectory(*truth, TimesOf(dataset.frames_)); });
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

double Dataset::MedianIntervalS() const {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    intervals_s.push_back(frames_[i].timestamp_s - frames_[i - 1].timestamp_s);
  }
  if (intervals_s.empty()) {
    return 0;
  }
  const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
  std::ranges::nth_element(intervals_s, middle);
  return *middle;
}

std::string Dataset::Summary() const {
  std::string text = fmt::format("{}: {} frames", Name(), frames_.size());
  if (frames_.size() != all_frames_) {
    text += fmt::format(" ({}:{} of {})", first_frame_, first_frame_ + frames_.size(), all_frames_);
  }
  if (color_images_without_depth_ > 0) {
    text += fmt::format("; {} of {} color images have no depth image within {} s and are left out",
                        color_images_without_depth_, listed_color_images_, options_.max_difference_s);
  }
  return text;
}

RgbdFrame Dataset::Load(std::size_t index, const PinholeCamera& camera) const {
  const DatasetFrame& frame = frames_.at(index);
  ImageFile color(frame.color_path);
  ImageFile depth(frame.depth_path);
  if (color.width() != depth.width() || color.height() != depth.height()) {
    throw InputError(
        fmt::format("{}: {} x {} pixels, its color image {} has {} x {}; depth registered to color is "
                    "wanted",
                    frame.depth_path.string(), depth.width(), depth.height(), frame.color_path.string(), color.width(),
                    color.height()));
  }
  CheckSize(color, camera);
  auto image = std::make_shared<Image8>(color.DecodeColor());
  auto depth_image = std::make_shared<Image16>(depth.DecodeDepth(camera.depth_scale));
  if (!ignored_.empty()) {
    ignored_.Apply(*image, *depth_image);
  }
  return {frame.timestamp_s, std::move(image), std::move(depth_image)};
}

Image8 LoadMask(const fs::path& path, const PinholeCamera& camera, bool keep_unsure) {
  ImageFile mask(path);
  CheckSize(mask, camera);
  return mask.DecodeMask(keep_unsure);
}

}  // namespace rds
