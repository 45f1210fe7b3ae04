// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_line.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <ostream>

namespace rds {
namespace {

constexpr double kTerminalInterval_s = 0.1;
constexpr double kLineInterval_s = 10;

}  // namespace

bool ProgressLine::IsDue(double now_s) const {
  return now_s - shown_at_s_ >= (terminal_ ? kTerminalInterval_s : kLineInterval_s);
}

void ProgressLine::Show(double now_s, const std::string& text) {
  shown_at_s_ = now_s;
  open_ = terminal_;
  if (terminal_) {
    out_ << "\r\x1b[K" << text << std::flush;
  } else {
    out_ << text << '\n' << std::flush;
  }
}

void ProgressLine::End() {
  if (open_) {
    open_ = false;
    out_ << '\n' << std::flush;
  }
}

std::string DurationText(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace rds
