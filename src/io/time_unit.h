// SPDX-License-Identifier: Apache-2.0
// In which unit time stamps are written.
#pragma once

#include <span>
#include <string>

namespace rds {

enum class TimeUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds, kFrames };

// Frames a second where time stamps are frame numbers.
inline constexpr double kFrameNumberRate_hz = 30;

// The unit of ascending time stamps, by their size (seconds since 1970 have ten digits) and their usual step (cameras
// take 2 to 500 pictures a second). Whole numbers that mostly rise by one, and are small, are frame numbers. Seconds
// where nothing speaks against it. `whole_only`: other units only if all are whole numbers (for trajectories, whose
// poses may be seconds apart).
[[nodiscard]] TimeUnit GuessTimeUnit(std::span<const double> times, bool whole_only);

[[nodiscard]] double SecondsIn(TimeUnit unit);
// "nanoseconds", for messages.
[[nodiscard]] std::string NameOf(TimeUnit unit);

}  // namespace rds
