// SPDX-License-Identifier: Apache-2.0
// How long threads wait for a lock and hold it.
#pragma once

#include <array>
#include <cstdint>

namespace rds {

// A distribution of times in constant memory: bins that grow by a tenth, from 0.1 us to a minute. A value.
class TimeHistogram {
 public:
  void Add(double milliseconds);

  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] double max_ms() const { return max_ms_; }
  // The time that a share of all times does not exceed, true to a twentieth; 0 without any.
  [[nodiscard]] double QuantileMs(double share) const;

 private:
  static constexpr int kBins = 220;

  std::array<std::int64_t, kBins> bins_{};
  std::int64_t count_ = 0;
  double max_ms_ = 0;
};

// Of one lock. A value: whoever holds the lock adds to it.
struct LockTimes {
  TimeHistogram held;
  TimeHistogram waited;
  TimeHistogram waited_by_tracking;  // by threads within a TrackingScope

  void Add(double waited_ms, double held_ms);
};

// Marks that the calling thread tracks a frame, so that its waits are told from those of others. Scopes may nest.
class TrackingScope {
 public:
  TrackingScope();
  ~TrackingScope();
  TrackingScope(const TrackingScope&) = delete;
  TrackingScope& operator=(const TrackingScope&) = delete;
};

}  // namespace rds
