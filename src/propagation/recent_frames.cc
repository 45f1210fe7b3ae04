// SPDX-License-Identifier: Apache-2.0
#include "propagation/recent_frames.h"

#include <array>
#include <cmath>
#include <cstdint>
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

bool RecentFrames::ReachBeyond(double timestamp_s) const {
  return !entries_.empty() && entries_.back().timestamp_s - timestamp_s >= kWitness_s;
}

std::vector<RecentFrames::Entry> RecentFrames::Witnesses(double timestamp_s,
                                                         const std::function<bool(FrameId)>& preferred) const {
  std::vector<std::uint8_t> is_preferred;
  for (const Entry& entry : entries_) {
    is_preferred.push_back(preferred(entry.frame) ? 1 : 0);
  }
  // Nothing if there is none near enough.
  const auto nearest = [&](double wanted_s, double tolerance_s) -> const Entry* {
    const Entry* best = nullptr;
    double least_s = 2 * tolerance_s;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const double off_s = std::abs(entries_[i].timestamp_s - wanted_s);
      if (const double counted_s = off_s + (is_preferred[i] != 0 ? 0 : tolerance_s);
          off_s <= tolerance_s && counted_s < least_s) {
        least_s = counted_s;
        best = &entries_[i];
      }
    }
    return best;
  };
  std::vector<Entry> witnesses;
  for (const double share : kDistances) {
    const double apart_s = share * kWitness_s;
    const Entry* found = nearest(timestamp_s - apart_s, kTolerance * apart_s);
    found = found != nullptr ? found : nearest(timestamp_s + apart_s, kTolerance * apart_s);
    if (found != nullptr && (witnesses.empty() || witnesses.back().frame != found->frame)) {
      witnesses.push_back(*found);
    }
  }
  return witnesses;
}

}  // namespace rds
