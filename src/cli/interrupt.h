// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: the first one asks the program to stop and write what it has, the second ends it at once.
#pragma once

#include <array>
#include <csignal>

namespace rds {

// While one lives, SIGINT, SIGTERM, SIGHUP (the terminal is closed), SIGQUIT, SIGXCPU and SIGXFSZ (a limit is reached)
// are noted instead of ending the program; the second one, unless of a limit, ends it with exit code 128 + signal, and
// leaves no temporary file behind. A signal that is ignored (nohup) stays so. Nor does the end of whoever reads the
// program's messages (SIGPIPE) end it before its results are written. The handlers before it are restored at the end.
// One at a time; made and destroyed on one thread.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  static constexpr std::array kNoted = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ};
  std::array<struct sigaction, kNoted.size()> before_{};
  struct sigaction before_pipe_ {};
};

// The signal noted since the InterruptGuard was made; 0 = none, or no guard. Any thread.
[[nodiscard]] int InterruptSignal();
[[nodiscard]] inline bool Interrupted() { return InterruptSignal() != 0; }

}  // namespace rds
