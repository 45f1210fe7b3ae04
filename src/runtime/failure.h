// SPDX-License-Identifier: Apache-2.0
// The error that ends a run, from whichever thread it came.
#pragma once

#include <atomic>
#include <exception>
#include <mutex>
#include <utility>

namespace rds {

// Keeps the first error of several threads. Any thread may call anything.
class Failure {
 public:
  void Set(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (error_ == nullptr) {
      error_ = std::move(error);
      happened_.store(true, std::memory_order_release);
    }
  }
  // Takes no lock.
  [[nodiscard]] bool Happened() const { return happened_.load(std::memory_order_acquire); }
  // Null before the first.
  [[nodiscard]] std::exception_ptr Get() const {
    const std::lock_guard lock(mutex_);
    return error_;
  }
  void ThrowIfHappened() const {
    if (Happened()) {
      std::rethrow_exception(Get());
    }
  }

 private:
  mutable std::mutex mutex_;
  std::exception_ptr error_;
  std::atomic<bool> happened_ = false;
};

}  // namespace rds
