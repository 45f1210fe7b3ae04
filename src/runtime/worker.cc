#include "runtime/worker.h"

#include <chrono>
#include <exception>
#include <utility>

namespace rds {

Worker::Worker(std::function<void()> function) {
  std::packaged_task<void()> task(std::move(function));
  done_ = task.get_future();
  thread_ = std::thread(std::move(task));
}

Worker::~Worker() {
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Worker::Join() {
  if (thread_.joinable()) {
    thread_.join();
  }
  if (done_.valid()) {
    done_.get();
  }
}

bool Worker::WaitFor(double seconds) const {
  return !done_.valid() || done_.wait_for(std::chrono::duration<double>(seconds)) == std::future_status::ready;
}

void Worker::Abandon() {
  if (thread_.joinable()) {
    thread_.detach();
  }
}

}  // namespace rds
