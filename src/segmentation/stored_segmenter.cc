// SPDX-License-Identifier: Apache-2.0
#include "segmentation/stored_segmenter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/error.h"
#include "base/log.h"

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

}  // namespace

StoredSegmenter::StoredSegmenter(std::vector<StoredMask> masks, MaskReader reader, double delay_ms)
    : masks_((Validate(masks, delay_ms), std::move(masks))), reader_(std::move(reader)), delay_(delay_ms) {}

std::vector<Image8> StoredSegmenter::Segment(std::span<const SegmentationInput> inputs) {
  const auto due =
      std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(delay_);
  std::vector<Image8> answer(inputs.size());
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    try {
      if (const StoredMask* const mask = Find(inputs[i].timestamp_s)) {
        answer[i] = reader_(mask->path);
      } else {
        throw InputError(
            fmt::format("mask.txt has no mask within {} s of {:.6f} s", kMaxTimeDifference_s, inputs[i].timestamp_s));
      }
    } catch (const InputError& error) {
      problems.emplace_back(error.what());
    }
  }
  if (!WaitUntil(due)) {
    return std::vector<Image8>(inputs.size());
  }
  if (!problems.empty() && problems.size() == inputs.size()) {
    throw InputError(fmt::format("{}", fmt::join(problems, "; ")));
  }
  constexpr int kMostSaid = 5;  // a sequence may have masks for every other frame only
  for (const std::string& problem : problems) {
    if (++said_ <= kMostSaid) {
      log::warn("{}{}", problem, said_ == kMostSaid ? "; more are counted, not shown" : "");
    }
  }
  return answer;
}

void StoredSegmenter::Cancel() {
  {
    const std::lock_guard lock(mutex_);
    canceled_ = true;
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
  return !cancel_asked_.wait_until(lock, due, [this] { return canceled_; });
}

}  // namespace rds
