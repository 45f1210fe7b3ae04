// SPDX-License-Identifier: Apache-2.0
#include "io/time_unit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"

namespace rds {
namespace {

// Seconds since 1970 in each unit have their own number of digits; nothing for smaller numbers.
TimeUnit BySize(double time) {
  return time > 1e17   ? TimeUnit::kNanoseconds
         : time > 1e14 ? TimeUnit::kMicroseconds
         : time > 1e11 ? TimeUnit::kMilliseconds
                       : TimeUnit::kSeconds;
}

TimeUnit ByStep(double step, bool whole, double last) {
  constexpr double kSmall = 1e6;
  return step > 1.5e6                                       ? TimeUnit::kNanoseconds
         : step > 1.5e3                                     ? TimeUnit::kMicroseconds
         : whole && step >= 1 && step <= 2 && last < kSmall ? TimeUnit::kFrames
         : step > 2                                         ? TimeUnit::kMilliseconds
                                                            : TimeUnit::kSeconds;
}

}  // namespace

TimeUnit GuessTimeUnit(std::span<const double> times, bool whole_only) {
  const TimeUnit by_size = times.empty() ? TimeUnit::kSeconds : BySize(times.front());
  if (times.size() < 3) {
    return by_size;
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    steps.push_back(times[i] - times[i - 1]);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  constexpr double kLongestStep_s = 60;  // else it is the time since a start, in a finer unit
  if (by_size != TimeUnit::kSeconds && *middle * SecondsIn(by_size) < kLongestStep_s) {
    return by_size;
  }
  const bool whole = std::ranges::all_of(times, [](double time) { return time == std::floor(time); });
  return whole_only && !whole ? TimeUnit::kSeconds : ByStep(*middle, whole, times.back());
}

double SecondsIn(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return 1;
    case TimeUnit::kMilliseconds:
      return 1e-3;
    case TimeUnit::kMicroseconds:
      return 1e-6;
    case TimeUnit::kNanoseconds:
      return 1e-9;
    case TimeUnit::kFrames:
      return 1 / kFrameNumberRate_hz;
  }
  throw InvariantError("unknown unit of time");
}

std::string NameOf(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return "seconds";
    case TimeUnit::kMilliseconds:
      return "milliseconds";
    case TimeUnit::kMicroseconds:
      return "microseconds";
    case TimeUnit::kNanoseconds:
      return "nanoseconds";
    case TimeUnit::kFrames:
      return "frame numbers";
  }
  throw InvariantError("unknown unit of time");
}

}  // namespace rds
