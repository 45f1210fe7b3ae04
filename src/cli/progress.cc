// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace rds {
namespace {

constexpr std::size_t kBarWidth = 24;

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

Progress::Progress(std::ostream& out, bool terminal, std::size_t frames) : line_(out, terminal), frames_(frames) {}

void Progress::Update(const FrameResult& result, double elapsed_s) {
  ++done_;
  elapsed_s_ = elapsed_s;
  rate_.Tick(elapsed_s);
  newest_ = result;
  newest_.features.clear();
  if (line_.IsDue(elapsed_s)) {
    Print();
  }
}

void Progress::Finish() {
  if (done_ > printed_done_) {
    Print();
  }
  line_.End();
}

void Progress::Print() {
  printed_done_ = done_;
  const double left_s = elapsed_s_ / static_cast<double>(done_) * static_cast<double>(frames_ - done_);
  const std::size_t filled = kBarWidth * done_ / std::max<std::size_t>(frames_, 1);
  const std::string bar =
      line_.terminal() ? "[" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "] " : std::string();
  line_.Show(elapsed_s_, fmt::format("{}{}/{}  {:.1f} fps  {}  {} keyframes  {} points  {} left", bar, done_, frames_,
                                     rate_.PerSecond(), ToString(newest_.state), newest_.keyframes_in_map,
                                     newest_.points_in_map, DurationText(left_s)));
}

}  // namespace rds
