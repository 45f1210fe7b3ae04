// SPDX-License-Identifier: Apache-2.0
// Keyframes that wait for their label, and which of them go next: the paper's section IV-A.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "base/ids.h"
#include "base/image.h"
#include "feature/frame_data.h"
#include "semantic/semantic_options.h"

namespace rds {

struct BacklogItem {
  FrameId frame;  // of the keyframe
  double timestamp_s = 0;
  std::shared_ptr<const Image8> image;
  std::shared_ptr<const FrameData> data;
  bool from_front = false;  // set by Select: goes on to the semantic-based optimization
  bool again = false;       // labeled before, without frames to compare it with; there are some now
};

// Holds the images of unlabeled keyframes, at most `capacity`. Every item leaves it once: selected, or dropped when
// room is needed (from the middle, so that the oldest and the newest stay). Not thread-safe by itself.
class Backlog {
 public:
  explicit Backlog(std::size_t capacity) : capacity_(capacity) {}

  // Frames ascend. Returns how many items were dropped to make room (0 or 1).
  int Push(BacklogItem item);
  // Takes out up to `count` items. Bidirectional: alternately from the front and from the back, the same item never
  // twice; a single item counts as front.
  [[nodiscard]] std::vector<BacklogItem> Select(SelectionMode mode, std::size_t count);

  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] bool empty() const { return items_.empty(); }

 private:
  BacklogItem TakeFront();
  BacklogItem Revert();

  std::size_t capacity_;
  std::deque<BacklogItem> items_;  // ascending by frame
};

}  // namespace rds
