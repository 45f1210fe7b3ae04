// SPDX-License-Identifier: Apache-2.0
// Progress of a run: a bar on a terminal, plain lines elsewhere.
#pragma once

#include <cstddef>
#include <deque>
#include <iosfwd>
#include <string>

#include "cli/progress_line.h"
#include "system/frame.h"

namespace rds {

// Frames a second over the last second. Not thread-safe.
class FrameRateMeter {
 public:
  // A frame was done at this time, in seconds of any clock.
  void Tick(double time_s);
  // 0 before the second frame.
  [[nodiscard]] double PerSecond() const;

 private:
  std::deque<double> times_s_;
};

// Prints as ProgressLine does. Not thread-safe.
class Progress {
 public:
  Progress(std::ostream& out, bool terminal, std::size_t frames);

  // After each frame; `elapsed_s` since the run began.
  void Update(const FrameResult& result, double elapsed_s);
  // Shows the newest state and ends the line.
  void Finish();

 private:
  void Print();

  ProgressLine line_;
  const std::size_t frames_;
  std::size_t done_ = 0;
  FrameResult newest_;  // without features
  FrameRateMeter rate_;
  double elapsed_s_ = 0;
  std::size_t printed_done_ = 0;
};

}  // namespace rds
