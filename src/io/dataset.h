// SPDX-License-Identifier: Apache-2.0
// RGB-D sequences in the folder layout of the TUM and Bonn benchmarks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "geometry/camera.h"
#include "geometry/trajectory.h"
#include "io/ignored_pixels.h"
#include "system/frame.h"

namespace rds {

// Frames [begin, end) of a sequence, counted from 0 after association; `end` absent means the last one.
struct FrameRange {
  std::size_t begin = 0;
  std::optional<std::size_t> end;
};

// Reads "A:B", "A:", ":B" or ":". InputError with the forms for anything else, and where A is not below B.
FrameRange ParseFrameRange(const std::string& text);

struct DatasetOptions {
  double max_difference_s = 0.02;  // between the times of a color image and its depth image (or its mask)
  FrameRange frames;
  bool needs_masks = false;     // what is wrong with mask.txt is an error then, else a warning
  std::filesystem::path masks;  // folder with the mask.txt to take; empty: the sequence's own
};

// One entry of the index: where the images of a frame lie. Times in seconds.
struct DatasetFrame {
  double timestamp_s = 0;  // of the color image: the frame's
  double depth_timestamp_s = 0;
  std::filesystem::path color_path;
  std::filesystem::path depth_path;
  std::filesystem::path mask_path;  // empty where there is none
};

// A folder with rgb.txt and depth.txt (also color.txt, aligned_depth.txt), or associations.txt (also associate.txt,
// association.txt, associated.txt); groundtruth.txt and mask.txt if there. Times may be seconds, milli-, micro- or
// nanoseconds, or frame numbers (see io/time_unit.h); here they are seconds.
// Without an association file every color image gets the depth image that is nearest in time: pairs are taken in order
// of their difference, up to the limit, each image at most once. Color images without a partner are left out and
// counted. The index is read and checked when opened (each listed image must be there); images are read on demand.
// But for Ignore immutable once opened: any number of threads may load frames at once.
class Dataset {
 public:
  // InputError, naming file and line, for a missing folder or list, an empty list, a malformed row, timestamps that do
  // not increase, a listed image that is not there, a range beyond the sequence, no pair at all. Ground truth that
  // cannot be read is left out with a warning, and so are masks unless they are needed.
  static Dataset Open(const std::filesystem::path& folder, const DatasetOptions& options = {});

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  // The folder's own name, for reports.
  [[nodiscard]] std::string Name() const;
  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  [[nodiscard]] const std::vector<DatasetFrame>& frames() const { return frames_; }
  [[nodiscard]] const std::optional<Trajectory>& ground_truth() const { return ground_truth_; }
  [[nodiscard]] bool HasMasks() const { return has_masks_; }
  // Whether the masks have unsure pixels: those that `rds segment` wrote.
  [[nodiscard]] bool MasksHaveUnsure() const { return masks_have_unsure_; }
  // Color images listed, and those left out for want of a depth image; over the whole sequence, whatever the range.
  [[nodiscard]] std::size_t listed_color_images() const { return listed_color_images_; }
  [[nodiscard]] std::size_t color_images_without_depth() const { return color_images_without_depth_; }

  // The usual time from one frame to the next; 0 for a single frame.
  [[nodiscard]] double MedianIntervalS() const;

  // One sentence for the user: how many frames, and how many were left out and why.
  [[nodiscard]] std::string Summary() const;

  // Of every frame that is loaded from then on.
  void Ignore(IgnoredPixels pixels) { ignored_ = std::move(pixels); }

  // Both images of a frame, checked against each other and the camera. InputError names the file and what to do.
  [[nodiscard]] RgbdFrame Load(std::size_t index, const PinholeCamera& camera) const;

 private:
  std::filesystem::path folder_;
  DatasetOptions options_;
  std::vector<DatasetFrame> frames_;
  std::optional<Trajectory> ground_truth_;
  bool has_masks_ = false;
  bool masks_have_unsure_ = false;
  IgnoredPixels ignored_;
  std::size_t listed_color_images_ = 0;
  std::size_t color_images_without_depth_ = 0;
  std::size_t first_frame_ = 0;
  std::size_t all_frames_ = 0;
};

// How the comment above the rows of a mask.txt begins that `rds segment` wrote: its times are seconds whatever those of
// the sequence are, and 128 in a mask is unsure.
inline constexpr const char* kSegmentedMasks = "# rds segment:";

// A mask of the camera's size: 255 = dynamic, 0 = not, and with `keep_unsure` 128 = unsure. InputError naming the file.
[[nodiscard]] Image8 LoadMask(const std::filesystem::path& path, const PinholeCamera& camera, bool keep_unsure = false);

}  // namespace rds
