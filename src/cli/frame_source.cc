#include "cli/frame_source.h"

#include <atomic>
#include <utility>

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

  std::optional<RgbdFrame> Next() {
    std::optional<RgbdFrame> frame = queue_.Pop();
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
      BoundedQueue<RgbdFrame>& queue;
      ~Closer() { queue.Close(); }
    } const closer{queue_};
    for (std::size_t i = 0; i < dataset_.size(); ++i) {
      RgbdFrame frame = dataset_.Load(i, camera_);
      cpu_s_ = ThreadCpuSeconds();
      if (!queue_.Push(std::move(frame))) {
        return;
      }
    }
  }

  const Dataset& dataset_;
  const PinholeCamera camera_;
  BoundedQueue<RgbdFrame> queue_{kFramesAhead};
  std::atomic<double> cpu_s_ = 0;
  Worker worker_;  // last: joined before the rest is destroyed
};

FrameSource::FrameSource(const Dataset& dataset, const PinholeCamera& camera)
    : impl_(std::make_unique<Impl>(dataset, camera)) {}
FrameSource::~FrameSource() = default;
std::optional<RgbdFrame> FrameSource::Next() { return impl_->Next(); }
double FrameSource::CpuSeconds() const { return impl_->CpuSeconds(); }

}  // namespace rds
