#include "semantic/stored_segmenter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/error.h"

namespace rds {
namespace {

void Validate(const std::vector<StoredMask>& masks, double delay_ms) {
  if (masks.empty()) {
    throw InputError("segmenter 'stored': the sequence has no masks (mask.txt); use --segmenter openvino or none");
  }
  if (!std::isfinite(delay_ms) || delay_ms < 0) {
    throw InputError(fmt::format("semantic.stored.delay_ms: {} must be 0 or more", delay_ms));
  }
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const StoredMask& mask = masks[i];
    if (!std::isfinite(mask.timestamp_s) || (i > 0 && mask.timestamp_s <= masks[i - 1].timestamp_s)) {
      throw InputError(fmt::format("mask {}: time {} is not after the one before", mask.path, mask.timestamp_s));
    }
    if (!std::filesystem::exists(mask.path)) {
      throw InputError(fmt::format("mask {}: no such file", mask.path));
    }
  }
}

Image8 Load(const std::string& path) {
  cv::Mat image = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (image.empty() || image.depth() != CV_8U) {
    throw InputError(fmt::format("mask {}: not a readable 8-bit image", path));
  }
  if (image.channels() > 1) {
    cv::Mat first;
    cv::extractChannel(image, first, 0);
    image = first;
  }
  Image8 mask(image.cols, image.rows);
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* const row = image.ptr<std::uint8_t>(y);
    std::transform(row, row + image.cols, mask.Row(y),
                   [](std::uint8_t value) { return static_cast<std::uint8_t>(value != 0 ? 255 : 0); });
  }
  return mask;
}

}  // namespace

StoredSegmenter::StoredSegmenter(std::vector<StoredMask> masks, double delay_ms)
    : masks_((Validate(masks, delay_ms), std::move(masks))), delay_(delay_ms) {}

std::vector<Image8> StoredSegmenter::Segment(std::span<const SegmentationInput> inputs) {
  const auto due =
      std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(delay_);
  std::vector<Image8> answer(inputs.size());
  std::exception_ptr failure;
  try {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (const StoredMask* const mask = Find(inputs[i].timestamp_s)) {
        answer[i] = Load(mask->path);
      }
    }
  } catch (const InputError&) {
    failure = std::current_exception();
  }
  if (!WaitUntil(due)) {
    return std::vector<Image8>(inputs.size());
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
  return answer;
}

void StoredSegmenter::Cancel() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
  }
  cancel_asked_.notify_all();
}

std::string StoredSegmenter::Name() const { return fmt::format("stored, {:g} ms", delay_.count()); }

const StoredMask* StoredSegmenter::Find(double timestamp_s) const {
  const auto after = std::lower_bound(masks_.begin(), masks_.end(), timestamp_s,
                                      [](const StoredMask& mask, double time) { return mask.timestamp_s < time; });
  const StoredMask* nearest = after != masks_.end() ? &*after : nullptr;
  if (after != masks_.begin()) {
    const StoredMask& before = *std::prev(after);
    if (nearest == nullptr || timestamp_s - before.timestamp_s <= nearest->timestamp_s - timestamp_s) {
      nearest = &before;
    }
  }
  // The smallest bit of leeway, so that a difference of 0.02 s written in decimals still counts.
  return std::abs(nearest->timestamp_s - timestamp_s) <= kMaxTimeDifference_s + 1e-6 ? nearest : nullptr;
}

bool StoredSegmenter::WaitUntil(std::chrono::steady_clock::time_point due) {
  std::unique_lock lock(mutex_);
  return !cancel_asked_.wait_until(lock, due, [this] { return cancelled_; });
}

}  // namespace rds
