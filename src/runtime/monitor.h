// SPDX-License-Identifier: Apache-2.0
// A value behind a lock, with a condition variable: threads can wait for it to change.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace rds {

// Like Guarded; every Write wakes those who Wait. Nothing slow inside.
template <typename T>
class Monitor {
 public:
  template <typename... Arguments>
  explicit Monitor(Arguments&&... arguments) : value_(std::forward<Arguments>(arguments)...) {}

  template <typename Function>
  auto Read(Function&& function) const {
    const std::lock_guard lock(mutex_);
    return std::forward<Function>(function)(std::as_const(value_));
  }

  template <typename Function>
  auto Write(Function&& function) {
    const Notifier notifier{changed_};
    const std::lock_guard lock(mutex_);
    return std::forward<Function>(function)(value_);
  }

  // Waits until `ready(value)` is true, then runs `function` on the value.
  template <typename Predicate, typename Function>
  auto WaitAndWrite(Predicate&& ready, Function&& function) {
    const Notifier notifier{changed_};
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ready(std::as_const(value_)); });
    return std::forward<Function>(function)(value_);
  }

  // Waits until `ready(value)` is true, at most so long; returns whether it is.
  template <typename Predicate>
  bool WaitFor(double seconds, Predicate&& ready) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return ready(value_); });
  }

 private:
  struct Notifier {  // notifies once the lock, taken after it, is released
    std::condition_variable& changed;
    ~Notifier() { changed.notify_all(); }
  };

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  T value_;
};

}  // namespace rds
