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
constexpr double kTolerance = 0.25;                             // of a distance, that a preferred frame may be off

}  // namespace

void RecentFrames::Add(Entry entry) {
  entries_.push_back(std::move(entry));
  if (entries_.size() > kMost) {
    entries_.pop_front();
  }
}

std::vector<RecentFrames::Entry> RecentFrames::Witnesses(double timestamp_s, std::span<const FrameId> preferred) const {
  std::vector<Entry> witnesses;
  for (const double share : kDistances) {
    const double apart_s = share * kWitness_s;
    const auto off_s = [&](const Entry& entry, double wanted_s) {
      return std::abs(entry.timestamp_s - wanted_s) +
             (std::ranges::binary_search(preferred, entry.frame) ? 0 : kTolerance * apart_s);
    };
    for (const double wanted_s : {timestamp_s - apart_s, timestamp_s + apart_s}) {
      const auto nearest =
          std::ranges::min_element(entries_, {}, [&](const Entry& entry) { return off_s(entry, wanted_s); });
      if (nearest == entries_.end() || std::abs(nearest->timestamp_s - wanted_s) > 1.01 * kTolerance * apart_s) {
        continue;
      }
      if (witnesses.empty() || witnesses.back().frame != nearest->frame) {
        witnesses.push_back(*nearest);
      }
      break;
    }
  }
  return witnesses;
}

}  // namespace rds
