// SPDX-License-Identifier: Apache-2.0
#include "cli/reference_timing.h"

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/time.h"

namespace rds {

class ReferenceTiming::Impl {
 public:
  void Measure(const RgbdFrame& frame) {
    const double cpu_before_s = ThreadCpuSeconds();
    const Image8& image = *frame.image;
    const cv::Mat recorded(image.height, image.width, image.channels == 3 ? CV_8UC3 : CV_8UC1,
                           const_cast<std::uint8_t*>(image.data.data()));
    if (image.channels == 3) {
      cv::cvtColor(recorded, gray_, cv::COLOR_BGR2GRAY);
    } else {
      recorded.copyTo(gray_);
    }
    const Stopwatch watch;
    orb_->detectAndCompute(gray_, cv::noArray(), keypoints_, descriptors_);
    times_ms_.push_back(watch.Milliseconds());
    cpu_s_ += ThreadCpuSeconds() - cpu_before_s;
  }

  [[nodiscard]] const std::vector<double>& times_ms() const { return times_ms_; }
  [[nodiscard]] double cpu_s() const { return cpu_s_; }

 private:
  cv::Ptr<cv::ORB> orb_ = cv::ORB::create(1000, 1.2F, 8);
  cv::Mat gray_;
  cv::Mat descriptors_;
  std::vector<cv::KeyPoint> keypoints_;
  std::vector<double> times_ms_;
  double cpu_s_ = 0;
};

ReferenceTiming::ReferenceTiming() : impl_(std::make_unique<Impl>()) { cv::setNumThreads(1); }
ReferenceTiming::~ReferenceTiming() = default;
void ReferenceTiming::BeforeFrame(const RgbdFrame& frame) { impl_->Measure(frame); }
const std::vector<double>& ReferenceTiming::times_ms() const { return impl_->times_ms(); }
double ReferenceTiming::cpu_s() const { return impl_->cpu_s(); }

}  // namespace rds
