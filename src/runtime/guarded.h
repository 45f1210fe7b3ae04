// SPDX-License-Identifier: Apache-2.0
// A value behind a lock.
#pragma once

#include <mutex>
#include <utility>

namespace rds {

// Read and Write run a function on the value while holding the lock: copy in, copy out, nothing slow inside. Never
// nest two doors.
template <typename T>
class Guarded {
 public:
  template <typename... Arguments>
  explicit Guarded(Arguments&&... arguments) : value_(std::forward<Arguments>(arguments)...) {}

  template <typename Function>
  auto Read(Function&& function) const {
    const std::lock_guard lock(mutex_);
    return std::forward<Function>(function)(std::as_const(value_));
  }

  template <typename Function>
  auto Write(Function&& function) {
    const std::lock_guard lock(mutex_);
    return std::forward<Function>(function)(value_);
  }

 private:
  mutable std::mutex mutex_;
  T value_;
};

}  // namespace rds
