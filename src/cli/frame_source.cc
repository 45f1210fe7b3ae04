// SPDX-License-Identifier: Apache-2.0
#include "cli/frame_source.h"

#include <atomic>
#include <utility>

#include "base/error.h"
#include "base/time.h"
#include "runtime/bounded_queue.h"
#include "runtime/worker.h"

namespace rds {
namespace {

constexpr std::size_t kFramesAhead = 6;  // 1.5 MB each at 640 x 480

}  // namespace

class FrameSource::Impl {
 public:
  Impl(const Dataset& dataset, const PinholeCamera& camera)
      : dataset_(dataset), camera_(camera), worker_([this] { ReadAll(); }) {}
  ~Impl() { queue_.Close(); }

  std::optional<SourceFrame> Next() {
    std::optional<SourceFrame> frame = queue_.Pop();
    if (!frame) {
      worker_.Join();  // throws if the end is an error
    }
    return frame;
  }

  [[nodiscard]] double CpuSeconds() const { return cpu_s_; }

 private:
  void ReadAll() {
    // Closes the queue on an error as well, after the frames before it.
    struct Closer {
      BoundedQueue<SourceFrame>& queue;
      ~Closer() { queue.Close(); }
    } const closer{queue_};
    for (std::size_t i = 0; i < dataset_.size(); ++i) {
      SourceFrame frame{.index = i, .frame = std::nullopt};
      try {
        frame.frame = dataset_.Load(i, camera_);
      } catch (const InputError& error) {
        frame.problem = error.what();
      }
      cpu_s_ = ThreadCpuSeconds();
      if (!queue_.Push(std::move(frame))) {
        return;
      }
    }
  }

  const Dataset& dataset_;
  const PinholeCamera camera_;
  BoundedQueue<SourceFrame> queue_{kFramesAhead};
  std::atomic<double> cpu_s_ = 0;
  Worker worker_;  // last: joined before the rest is destroyed
};

FrameSource::FrameSource(const Dataset& dataset, const PinholeCamera& camera)
    : impl_(std::make_unique<Impl>(dataset, camera)) {}
FrameSource::~FrameSource() = default;
std::optional<SourceFrame> FrameSource::Next() { return impl_->Next(); }
double FrameSource::CpuSeconds() const { return impl_->CpuSeconds(); }

}  // namespace rds
