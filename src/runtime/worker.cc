// SPDX-License-Identifier: Apache-2.0
#include "runtime/worker.h"

#ifdef __linux__
#include <pthread.h>
#include <sched.h>
#include <unistd.h>
#endif

#include <chrono>
#include <exception>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"

namespace rds {

Worker::Worker(std::function<void()> function) {
  std::packaged_task<void()> task(std::move(function));
  done_ = task.get_future();
  try {
    thread_ = std::thread(std::move(task));
  } catch (const std::system_error& error) {
    throw InputError(std::string("no thread can be started (") + error.what() +
                     "); allow more processes (ulimit -u) or memory");
  }
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

void Worker::LeaveCallersCore() {
#ifdef __linux__
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) == 0) {
    CPU_CLR(sched_getcpu(), &cores);
    if (CPU_COUNT(&cores) > 0) {
      pthread_setaffinity_np(thread_.native_handle(), sizeof cores, &cores);
    }
  }
#endif
}

void Worker::StayOffCallersCore() {
#ifdef __linux__
  const int core = sched_getcpu();
  if (core != callers_core_) {
    callers_core_ = core;
    LeaveCallersCore();
  }
#endif
}

void Worker::UseAllCores() {
#ifdef __linux__
  cpu_set_t cores;
  if (sched_getaffinity(getpid(), sizeof cores, &cores) == 0) {
    sched_setaffinity(0, sizeof cores, &cores);
  }
#endif
}

void Worker::Abandon() {
  if (thread_.joinable()) {
    thread_.detach();
  }
}

}  // namespace rds
