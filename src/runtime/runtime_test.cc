// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#ifdef __linux__
#include <sched.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <vector>

#include "runtime/bounded_queue.h"
#include "runtime/guarded.h"
#include "runtime/lock_times.h"
#include "runtime/monitor.h"
#include "runtime/published.h"
#include "runtime/worker.h"

namespace rds {
namespace {

TEST(BoundedQueue, RefusesWhatDoesNotFitAndKeepsOrder) {
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(queue.TryPush(1));
  EXPECT_TRUE(queue.TryPush(2));
  EXPECT_FALSE(queue.TryPush(3));
  EXPECT_EQ(queue.Pop(), 1);
  EXPECT_TRUE(queue.TryPush(4));
  EXPECT_EQ(queue.Pop(), 2);
  EXPECT_EQ(queue.Pop(), 4);
  EXPECT_EQ(queue.Size(), 0U);
}

TEST(BoundedQueue, AfterCloseDrainsAndTakesNothing) {
  BoundedQueue<int> queue(4);
  ASSERT_TRUE(queue.TryPush(1));
  queue.Close();
  EXPECT_FALSE(queue.TryPush(2));
  EXPECT_FALSE(queue.Push(2));
  EXPECT_EQ(queue.Pop(), 1);
  EXPECT_EQ(queue.Pop(), std::nullopt);
}

TEST(BoundedQueue, CarriesEverythingBetweenThreads) {
  BoundedQueue<int> queue(3);
  std::atomic<long> sum = 0;
  {
    Worker consumer([&] {
      while (const auto item = queue.Pop()) {
        sum += *item;
      }
    });
    Worker producer([&] {
      for (int i = 1; i <= 1000; ++i) {
        EXPECT_TRUE(queue.Push(int{i}));
      }
      queue.Close();
    });
    producer.Join();
    consumer.Join();
  }
  EXPECT_EQ(sum, 500500);
}

TEST(BoundedQueue, CloseWakesAWaitingConsumer) {
  BoundedQueue<int> queue(1);
  Worker consumer([&] { EXPECT_EQ(queue.Pop(), std::nullopt); });
  queue.Close();
  consumer.Join();
}

TEST(Published, GivesTheLatestAndKeepsWhatReadersHold) {
  Published<int> published;
  EXPECT_EQ(published.Get(), nullptr);
  published.Publish(std::make_shared<const int>(1));
  const auto held = published.Get();
  published.Publish(std::make_shared<const int>(2));
  EXPECT_EQ(*held, 1);
  EXPECT_EQ(*published.Get(), 2);
}

TEST(Published, IsReadWhileItIsWritten) {
  Published<int> published;
  published.Publish(std::make_shared<const int>(0));
  Worker writer([&] {
    for (int i = 1; i <= 2000; ++i) {
      published.Publish(std::make_shared<const int>(i));
    }
  });
  int last = 0;
  for (int i = 0; i < 2000; ++i) {
    const int now = *published.Get();
    EXPECT_GE(now, last);
    last = now;
  }
  writer.Join();
  EXPECT_EQ(*published.Get(), 2000);
}

TEST(Guarded, WritesDoNotOverlap) {
  Guarded<int> value(0);
  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < 4; ++i) {
    workers.push_back(std::make_unique<Worker>([&] {
      for (int k = 0; k < 1000; ++k) {
        value.Write([](int& v) { ++v; });
      }
    }));
  }
  workers.clear();
  EXPECT_EQ(value.Read([](const int& v) { return v; }), 4000);
}

TEST(Monitor, WakesTheWaitingThread) {
  Monitor<int> value(0);
  Worker waiter([&] {
    const int seen = value.WaitAndWrite([](const int& v) { return v >= 3; }, [](int& v) { return v++; });
    EXPECT_EQ(seen, 3);
  });
  for (int i = 0; i < 3; ++i) {
    value.Write([](int& v) { ++v; });
  }
  waiter.Join();
  EXPECT_EQ(value.Read([](const int& v) { return v; }), 4);
}

TEST(Monitor, WaitForGivesUp) {
  const Monitor<int> value(0);
  EXPECT_FALSE(value.WaitFor(0.01, [](const int& v) { return v > 0; }));
  EXPECT_TRUE(value.WaitFor(10, [](const int& v) { return v == 0; }));
}

TEST(Worker, JoinThrowsWhatTheFunctionThrew) {
  Worker worker([] { throw std::runtime_error("broken"); });
  EXPECT_THROW(worker.Join(), std::runtime_error);
  worker.Join();  // a second time does nothing
}

TEST(Worker, WaitForTellsWhetherItHasEnded) {
  std::atomic<bool> go = false;
  Worker worker([&] {
    while (!go) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_FALSE(worker.WaitFor(0.01));
  go = true;
  EXPECT_TRUE(worker.WaitFor(10));
  worker.Join();
}

#ifdef __linux__
TEST(Worker, WakesUpOnAnotherCoreThanItsCallersAndThenUsesAll) {
  const auto cores_of_this_thread = [] {
    cpu_set_t cores;
    sched_getaffinity(0, sizeof cores, &cores);
    return CPU_COUNT(&cores);
  };
  const int all = cores_of_this_thread();
  BoundedQueue<int> bell(1);
  int awake = 0;
  int later = 0;
  Worker worker([&] {
    std::ignore = bell.Pop();
    awake = cores_of_this_thread();
    Worker::UseAllCores();
    later = cores_of_this_thread();
  });
  worker.LeaveCallersCore();
  ASSERT_TRUE(bell.TryPush(1));
  worker.Join();
  EXPECT_EQ(awake, std::max(all - 1, 1));
  EXPECT_EQ(later, all);
}
#endif

TEST(TimeHistogram, KnowsItsQuantilesToATwentieth) {
  TimeHistogram times;
  EXPECT_EQ(times.QuantileMs(0.5), 0);
  for (int i = 1; i <= 1000; ++i) {
    times.Add(0.01 * i);
  }
  EXPECT_EQ(times.count(), 1000);
  EXPECT_EQ(times.max_ms(), 10);
  EXPECT_NEAR(times.QuantileMs(0.5), 5, 0.25);
  EXPECT_NEAR(times.QuantileMs(0.95), 9.5, 0.48);
  EXPECT_LE(times.QuantileMs(1), 10);
  times.Add(0);
  times.Add(1e9);
  EXPECT_EQ(times.max_ms(), 1e9);
}

TEST(LockTimes, TellsTheWaitsOfTracking) {
  LockTimes times;
  times.Add(1, 2);
  {
    const TrackingScope scope;
    times.Add(3, 4);
    std::thread([&] { times.Add(5, 6); }).join();  // another thread does not track
  }
  times.Add(7, 8);
  EXPECT_EQ(times.waited_by_tracking.count(), 1);
  EXPECT_EQ(times.waited_by_tracking.max_ms(), 3);
  EXPECT_EQ(times.waited.max_ms(), 7);
  EXPECT_EQ(times.held.max_ms(), 8);
}

}  // namespace
}  // namespace rds
