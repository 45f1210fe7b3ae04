// SPDX-License-Identifier: Apache-2.0
// A thread that is always joined.
#pragma once

#include <functional>
#include <future>
#include <thread>

namespace rds {

// Runs a function on a thread of its own. The destructor joins; an exception that leaves the function is kept for
// Join, so no worker dies in silence. The owner must make the function return (by closing its queue, for instance)
// before it joins.
class Worker {
 public:
  // Throws InputError if the system gives no thread.
  explicit Worker(std::function<void()> function);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Waits for the function's end and throws what it threw. Later calls do nothing.
  void Join();

  // Waits at most `seconds` for the function's end; true if it has ended.
  [[nodiscard]] bool WaitFor(double seconds) const;

  // Lets the thread wake up on any core that the caller may use but the one the caller is on now; without effect where
  // there is no other. To be called just before the thread is woken: some schedulers wake it on the caller's core
  // although another is idle, and the caller has to stop for it. Once awake, the thread calls UseAllCores.
  void LeaveCallersCore();

  // The same for good: keeps the thread off whatever core the caller is on; a call costs a system call only where that
  // has changed. Low priority is no substitute: a scheduler of fair shares lets whatever waits for the core have a
  // slice of some milliseconds now and then. The thread must not call UseAllCores.
  void StayOffCallersCore();

  // Lets the calling thread run on all cores of the process again.
  static void UseAllCores();

  // Gives the thread up: it goes on alone until its function returns. Only for a function stuck in foreign code, that
  // shares ownership of everything it touches.
  void Abandon();

 private:
  std::future<void> done_;
  std::thread thread_;
  int callers_core_ = -1;  // that StayOffCallersCore left
};

}  // namespace rds
