// SPDX-License-Identifier: Apache-2.0
// Segmenters that fail in every way that SLAM must survive. For tests.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "segmentation/segmenter.h"

namespace rds {

// Answers after `delay` (nothing = never, until it is canceled) with what `answer` makes of the inputs; once
// canceled, with empty images. Thread-safe as Segmenter demands.
class FaultySegmenter final : public Segmenter {
 public:
  using Answer = std::function<std::vector<Image8>(std::span<const SegmentationInput>)>;

  FaultySegmenter(std::string name, std::optional<std::chrono::milliseconds> delay, Answer answer)
      : name_(std::move(name)), delay_(delay), answer_(std::move(answer)) {}

  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    std::unique_lock lock(mutex_);
    ++requests_;
    if (delay_) {
      changed_.wait_for(lock, *delay_, [this] { return canceled_; });
    } else {
      changed_.wait(lock, [this] { return canceled_; });
    }
    if (canceled_) {
      return std::vector<Image8>(inputs.size());
    }
    lock.unlock();
    return answer_(inputs);
  }

  void Cancel() override {
    {
      const std::lock_guard lock(mutex_);
      canceled_ = true;
    }
    changed_.notify_all();
  }

  [[nodiscard]] std::string Name() const override { return name_; }

  // Calls of Segment so far.
  [[nodiscard]] int requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

 private:
  const std::string name_;
  const std::optional<std::chrono::milliseconds> delay_;
  const Answer answer_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool canceled_ = false;  // under mutex_
  int requests_ = 0;       // under mutex_
};

namespace faulty {

using std::chrono::milliseconds;

// Masks of the inputs' size (changed by dw, dh), filled with `value`.
inline FaultySegmenter::Answer Filled(std::uint8_t value, int dw = 0, int dh = 0) {
  return [=](std::span<const SegmentationInput> inputs) {
    std::vector<Image8> masks;
    for (const SegmentationInput& input : inputs) {
      masks.emplace_back(input.image->width + dw, input.image->height + dh, 1, value);
    }
    return masks;
  };
}

inline std::unique_ptr<FaultySegmenter> Throws() {
  return std::make_unique<FaultySegmenter>(
      "throws", milliseconds(0),
      [](std::span<const SegmentationInput>) -> std::vector<Image8> { throw std::runtime_error("out of order"); });
}
inline std::unique_ptr<FaultySegmenter> Slow(milliseconds delay = milliseconds(10'000)) {
  return std::make_unique<FaultySegmenter>("slow", delay, Filled(0));
}
inline std::unique_ptr<FaultySegmenter> NeverAnswers() {
  return std::make_unique<FaultySegmenter>("never answers", std::nullopt, Filled(0));
}
inline std::unique_ptr<FaultySegmenter> WrongSize() {
  return std::make_unique<FaultySegmenter>("wrong size", milliseconds(0), Filled(0, -1, 3));
}
inline std::unique_ptr<FaultySegmenter> AllOnes() {
  return std::make_unique<FaultySegmenter>("all ones", milliseconds(0), Filled(255));
}
inline std::unique_ptr<FaultySegmenter> AllEmpty() {
  return std::make_unique<FaultySegmenter>("empty", milliseconds(0), [](std::span<const SegmentationInput> inputs) {
    return std::vector<Image8>(inputs.size());
  });
}
// Fewer answers than questions.
inline std::unique_ptr<FaultySegmenter> TooFew() {
  return std::make_unique<FaultySegmenter>("too few", milliseconds(0),
                                           [](std::span<const SegmentationInput>) { return std::vector<Image8>(); });
}

}  // namespace faulty
}  // namespace rds
