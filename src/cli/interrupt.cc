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
  if (noted_signal.exchange(signal) != 0) {
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
  sigaction(SIGINT, &action, &before_interrupt_);
  sigaction(SIGTERM, &action, &before_terminate_);
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, &before_pipe_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &before_interrupt_, nullptr);
  sigaction(SIGTERM, &before_terminate_, nullptr);
  sigaction(SIGPIPE, &before_pipe_, nullptr);
  noted_signal = 0;
}

int InterruptSignal() { return noted_signal; }

}  // namespace rds
