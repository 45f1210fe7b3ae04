// SPDX-License-Identifier: Apache-2.0
// What `rds serve` answers: a segmenter behind the Open Inference Protocol (KServe v2).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "io/http_server.h"
#include "segmentation/segmenter.h"

namespace rds {

// GET /v2, /v2/health/live, /v2/health/ready, /v2/models/NAME, /v2/models/NAME/ready; POST /v2/models/NAME/infer. Input
// "image": UINT8 [n, height, width, 3], RGB, or BYTES [n], files of images (JPEG, PNG). Output "mask": UINT8 [n,
// height, width] with the values of segmentation/mask.h. One request is computed at a time; `most_waiting` wait, more
// are answered with 503. Thread-safe.
class InferenceService {
 public:
  static constexpr int kMostImages = 8;  // in a request

  InferenceService(std::string name, std::unique_ptr<Segmenter> segmenter, int most_waiting);

  [[nodiscard]] HttpReply Answer(const HttpRequest& request);

  // Requests under way, and later ones, fail soon.
  void Cancel() { segmenter_->Cancel(); }

 private:
  [[nodiscard]] HttpReply Infer(const HttpRequest& request);

  const std::string name_;
  const int most_waiting_;
  const std::unique_ptr<Segmenter> segmenter_;
  std::mutex segmenting_;  // held while the segmenter works
  std::atomic<int> waiting_ = 0;
  std::atomic<std::uint32_t> images_ = 0;
};

}  // namespace rds
