// SPDX-License-Identifier: Apache-2.0
// A mailbox that holds the latest value.
#pragma once

#include <memory>
#include <mutex>
#include <utility>

namespace rds {

// One thread publishes immutable values, any thread takes the latest; the lock is held for a pointer copy only.
template <typename T>
class Published {
 public:
  void Publish(std::shared_ptr<const T> value) {
    const std::lock_guard lock(mutex_);
    value_.swap(value);  // the old value is destroyed with the argument, after the lock is released
  }

  // Unless the present value goes before it: `is_older(value, present)`.
  template <typename Compare>
  void PublishUnless(std::shared_ptr<const T> value, Compare&& is_older) {
    const std::lock_guard lock(mutex_);
    if (value_ == nullptr || !is_older(*value, *value_)) {
      value_.swap(value);
    }
  }

  // The latest value; null before the first.
  [[nodiscard]] std::shared_ptr<const T> Get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const T> value_;
};

}  // namespace rds
