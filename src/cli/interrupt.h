// Ctrl-C: the first one asks the program to stop and write what it has, the second ends it at once.
#pragma once

#include <csignal>

namespace rds {

// While one lives, SIGINT and SIGTERM are noted instead of ending the program; the second one ends it with exit code
// 128 + signal, and leaves no temporary file behind. Nor does the end of whoever reads the program's messages (SIGPIPE)
// end it before its results are written. The handlers before it are restored at the end. One at a time; made and
// destroyed on one thread.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction before_interrupt_ {};
  struct sigaction before_terminate_ {};
  struct sigaction before_pipe_ {};
};

// The signal noted since the InterruptGuard was made; 0 = none, or no guard. Any thread.
[[nodiscard]] int InterruptSignal();
[[nodiscard]] inline bool Interrupted() { return InterruptSignal() != 0; }

}  // namespace rds
