// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace rds {
namespace {

constexpr double kTerminalInterval_s = 0.1;
constexpr double kLineInterval_s = 2;
constexpr std::size_t kBarWidth = 24;

std::string StateName(TrackingState state) {
  switch (state) {
    case TrackingState::kNotInitialized:
      return "starting";
    case TrackingState::kTracked:
      return "tracked";
    case TrackingState::kLost:
      return "LOST";
  }
  return "?";
}

std::string Duration(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace

void FrameRateMeter::Tick(double time_s) {
  times_s_.push_back(time_s);
  while (times_s_.size() > 2 && times_s_.front() < time_s - 1) {
    times_s_.pop_front();
  }
}

double FrameRateMeter::PerSecond() const {
  if (times_s_.size() < 2 || times_s_.back() <= times_s_.front()) {
    return 0;
  }
  return static_cast<double>(times_s_.size() - 1) / (times_s_.back() - times_s_.front());
}

Progress::Progress(std::ostream& out, bool terminal, std::size_t frames)
    : out_(out), terminal_(terminal), frames_(frames) {}

void Progress::Update(const FrameResult& result, double elapsed_s) {
  ++done_;
  elapsed_s_ = elapsed_s;
  rate_.Tick(elapsed_s);
  newest_ = result;
  newest_.features.clear();
  if (elapsed_s - printed_at_s_ >= (terminal_ ? kTerminalInterval_s : kLineInterval_s)) {
    Print();
  }
}

void Progress::Finish() {
  if (done_ > printed_done_) {
    Print();
  }
  if (terminal_ && printed_done_ > 0) {
    out_ << '\n' << std::flush;
  }
}

void Progress::Print() {
  printed_at_s_ = elapsed_s_;
  printed_done_ = done_;
  const double left_s = elapsed_s_ / static_cast<double>(done_) * static_cast<double>(frames_ - done_);
  const std::string text =
      fmt::format("{}/{}  {:.1f} fps  {}  {} keyframes  {} points  {} left", done_, frames_, rate_.PerSecond(),
                  StateName(newest_.state), newest_.keyframes_in_map, newest_.points_in_map, Duration(left_s));
  if (terminal_) {
    const std::size_t filled = kBarWidth * done_ / std::max<std::size_t>(frames_, 1);
    out_ << "\r\x1b[K[" << std::string(filled, '#') << std::string(kBarWidth - filled, '.') << "] " << text
         << std::flush;
  } else {
    out_ << text << '\n' << std::flush;
  }
}

}  // namespace rds
