// SPDX-License-Identifier: Apache-2.0
#include "runtime/lock_times.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

constexpr double kLeast_ms = 1e-4;
constexpr double kGrowth = 1.1;

thread_local int tracking_scopes = 0;

}  // namespace

void TimeHistogram::Add(double milliseconds) {
  const double bin = std::log(std::max(milliseconds, kLeast_ms) / kLeast_ms) / std::log(kGrowth);
  ++bins_[static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0))];
  ++count_;
  max_ms_ = std::max(max_ms_, milliseconds);
}

double TimeHistogram::QuantileMs(double share) const {
  const auto wanted = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (int i = 0; i < kBins; ++i) {
    seen += bins_[static_cast<std::size_t>(i)];
    if (seen > 0 && seen >= wanted) {
      return std::min(max_ms_, kLeast_ms * std::pow(kGrowth, i + 0.5));
    }
  }
  return 0;
}

void LockTimes::Add(double waited_ms, double held_ms) {
  held.Add(held_ms);
  waited.Add(waited_ms);
  if (tracking_scopes > 0) {
    waited_by_tracking.Add(waited_ms);
  }
}

TrackingScope::TrackingScope() { ++tracking_scopes; }
TrackingScope::~TrackingScope() { --tracking_scopes; }

}  // namespace rds
