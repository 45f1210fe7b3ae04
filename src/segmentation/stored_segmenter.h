// SPDX-License-Identifier: Apache-2.0
// The back end "stored": masks that come with the sequence, delivered after a set time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "segmentation/segmenter.h"

namespace rds {

// One mask of a sequence.
struct StoredMask {
  double timestamp_s = 0;  // of the frame that it belongs to
  std::string path;
};

// Reads the mask at a path: one channel, 0 = static, else dynamic. May throw InputError. Called on the thread of the
// segmenter.
using MaskReader = std::function<Image8(const std::string& path)>;

// Stands in for a network of known cost (Mask R-CNN's 200 ms, SegNet's 30 ms), and is the oracle of ablations. A
// request, whether of one image or two, takes `delay_ms` from its start; 0 = as fast as the files are read (lockstep).
// Thread-safe as Segmenter demands.
class StoredSegmenter final : public Segmenter {
 public:
  // A mask belongs to an image if their times differ by no more.
  static constexpr double kMaxTimeDifference_s = 0.02;

  // Throws InputError if there are no masks, if a time is not finite or not after the one before, if a file is missing,
  // or if the delay is negative.
  StoredSegmenter(std::vector<StoredMask> masks, MaskReader reader, double delay_ms);

  // Throws InputError, after the delay, where no mask lies near enough in time or its file cannot be read: for a
  // request of several images, if that is so for all of them; else those are empty and the reason is logged.
  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override;
  void Cancel() override;
  [[nodiscard]] std::string Name() const override;

 private:
  [[nodiscard]] const StoredMask* Find(double timestamp_s) const;
  // False if canceled before.
  bool WaitUntil(std::chrono::steady_clock::time_point due);

  const std::vector<StoredMask> masks_;
  const MaskReader reader_;
  const std::chrono::duration<double, std::milli> delay_;
  std::mutex mutex_;
  std::condition_variable cancel_asked_;
  bool canceled_ = false;  // under mutex_
  int said_ = 0;           // problems logged; of the thread that calls Segment
};

}  // namespace rds
