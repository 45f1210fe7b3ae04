// SPDX-License-Identifier: Apache-2.0
#include "propagation/recent_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rds {
namespace {

constexpr std::size_t kMost = 64;
constexpr std::array kDistances = {1.0, 0.7, 0.5, 0.35, 0.25};  // of kWitness_s: where views turn away quickly

}  // namespace

void RecentFrames::Add(double timestamp_s, std::shared_ptr<const FrameData> data) {
  entries_.push_back({timestamp_s, std::move(data)});
  if (entries_.size() > kMost) {
    entries_.pop_front();
  }
}

std::vector<std::shared_ptr<const FrameData>> RecentFrames::Witnesses(double timestamp_s) const {
  std::vector<std::shared_ptr<const FrameData>> witnesses;
  const auto nearest = [&](double wanted_s) -> const Entry* {
    const auto by = [&](const Entry& entry) { return std::abs(entry.timestamp_s - wanted_s); };
    const auto found = std::ranges::min_element(entries_, {}, by);
    return found == entries_.end() ? nullptr : &*found;
  };
  for (const double share : kDistances) {
    const double apart_s = share * kWitness_s;
    const Entry* entry = nearest(timestamp_s - apart_s);
    if (entry == nullptr || timestamp_s - entry->timestamp_s < 0.8 * apart_s) {
      entry = nearest(timestamp_s + apart_s);
    }
    if (entry != nullptr && std::abs(entry->timestamp_s - timestamp_s) >= 0.8 * apart_s &&
        (witnesses.empty() || witnesses.back() != entry->data)) {
      witnesses.push_back(entry->data);
    }
  }
  return witnesses;
}

}  // namespace rds
