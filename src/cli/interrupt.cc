// SPDX-License-Identifier: Apache-2.0
#include "cli/interrupt.h"

#include <unistd.h>

#include <atomic>

#include "io/temporary_files.h"

namespace rds {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<int> noted_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void NoteSignal(int signal) {
  const bool limit = signal == SIGXCPU || signal == SIGXFSZ;  // these come again and again
  int none = 0;
  if (!noted_signal.compare_exchange_strong(none, signal) && !limit) {
    RemoveTemporaryFiles();
    _exit(128 + signal);
  }
}

}  // namespace

InterruptGuard::InterruptGuard() {
  noted_signal = 0;
  struct sigaction action {};
  action.sa_handler = NoteSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kNoted.size(); ++i) {
    sigaction(kNoted[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) {
      sigaction(kNoted[i], &action, nullptr);
    }
  }
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, &before_pipe_);
}

InterruptGuard::~InterruptGuard() {
  for (std::size_t i = 0; i < kNoted.size(); ++i) {
    sigaction(kNoted[i], &before_[i], nullptr);
  }
  sigaction(SIGPIPE, &before_pipe_, nullptr);
  noted_signal = 0;
}

int InterruptSignal() { return noted_signal; }

}  // namespace rds
