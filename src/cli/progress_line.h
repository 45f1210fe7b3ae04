// SPDX-License-Identifier: Apache-2.0
// One line that says how far long work is.
#pragma once

#include <iosfwd>
#include <string>

namespace rds {

// On a terminal one line that is rewritten at most ten times a second; elsewhere a line every ten seconds. Prints
// through the stream, which fails without a word: a closed terminal ends no work. Not thread-safe.
class ProgressLine {
 public:
  ProgressLine(std::ostream& out, bool terminal) : out_(out), terminal_(terminal) {}
  // Ends a line under way.
  ~ProgressLine() { End(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  [[nodiscard]] bool terminal() const { return terminal_; }
  // Whether it is time for the next one, `now_s` after the work began.
  [[nodiscard]] bool IsDue(double now_s) const;
  void Show(double now_s, const std::string& text);
  void End();

 private:
  std::ostream& out_;
  const bool terminal_;
  double shown_at_s_ = 0;
  bool open_ = false;  // the line on the terminal
};

// "12 s", "3:05 min".
[[nodiscard]] std::string DurationText(double seconds);

}  // namespace rds
