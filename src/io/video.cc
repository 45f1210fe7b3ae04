// SPDX-License-Identifier: Apache-2.0
#include "io/video.h"

#include <spdlog/fmt/fmt.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/atomic_file.h"
#include "io/image_io.h"
#include "io/temporary_files.h"
#include "runtime/bounded_queue.h"
#include "runtime/worker.h"

namespace rds {
namespace {

constexpr std::size_t kQueueCapacity = 30;

void CheckExtension(const std::filesystem::path& file, const std::string& wanted) {
  if (file.extension() != wanted) {
    throw InputError(fmt::format("{}: expected a name that ends in {}", file.string(), wanted));
  }
}

cv::Mat ColorView(const Image8& image) {
  return {image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.data.data())};
}

// An MPEG-4 file under way.
class VideoFile {
 public:
  VideoFile(const std::filesystem::path& file, double frames_per_s, cv::Size size)
      : file_(file), temporary_(file) {  // made here, so that FFmpeg writes into a file of ours
    const bool opened = writer_.open(temporary_.path().string(), cv::CAP_FFMPEG,
                                     cv::VideoWriter::fourcc('m', 'p', '4', 'v'), frames_per_s, size);
    if (!opened) {
      throw InputError(fmt::format("{}: cannot be written as video: is the disk full, or OpenCV built without FFmpeg?",
                                   file.string()));
    }
  }

  void Write(const Image8& picture) {
    writer_.write(ColorView(picture));
    ++frames_;
  }

  // OpenCV does not report write errors, so the file is read back.
  void Finish() {
    writer_.release();
    if (frames_ == 0) {
      throw InputError(fmt::format("{}: no video, because no frame was recorded", file_.string()));
    }
    cv::VideoCapture written(temporary_.path().string(), cv::CAP_FFMPEG);
    if (!written.isOpened() || written.get(cv::CAP_PROP_FRAME_COUNT) < frames_) {
      throw InputError(
          fmt::format("{}: the video is incomplete and left out; is the disk full? make room or choose another place",
                      file_.string()));
    }
    if (const int error = temporary_.MoveTo(file_); error != 0) {
      throw InputError(fmt::format("{}: cannot be written: {}", file_.string(), std::strerror(error)));
    }
  }

 private:
  const std::filesystem::path file_;
  TemporaryPath temporary_;
  cv::VideoWriter writer_;
  int frames_ = 0;
};

}  // namespace

class VideoRecorder::Impl {
 public:
  Impl(const VideoOptions& options, int image_width, int image_height) : options_(options) {
    if (options.video) {
      CheckExtension(*options.video, ".mp4");
      CheckWritable(*options.video);  // a bad place fails now rather than at the end
      const cv::Size size(RunView::Width(image_width, image_height), RunView::Height(image_height));
      video_ = std::make_unique<VideoFile>(*options.video, options.frames_per_s, size);
    }
    if (options.still) {
      CheckExtension(*options.still, ".png");
      CheckWritable(*options.still);
    }
    worker_ = std::make_unique<Worker>([this] { Work(); });
  }

  ~Impl() { queue_.Close(); }

  [[nodiscard]] bool Wants(FrameId frame) const {
    return options_.video.has_value() || !options_.still_frame || frame <= *options_.still_frame;
  }

  void Add(RunViewContent content) {
    if (!Wants(content.result.frame)) {
      return;
    }
    const bool wait = options_.wait || options_.still_frame == content.result.frame;
    Item item{std::move(content), std::exchange(skipped_, 0)};
    const int skipped = item.skipped_before;
    if (!(wait ? queue_.Push(std::move(item)) : queue_.TryPush(std::move(item)))) {
      skipped_ = skipped + 1;
      ++left_out_;
    }
  }

  void Finish() {
    queue_.Close();
    worker_->Join();
    std::string problems = FinishVideo();
    try {
      FinishStill();
    } catch (const InputError& error) {
      problems += (problems.empty() ? "" : "; ") + std::string(error.what());
    }
    if (!problems.empty()) {
      throw InputError(problems);
    }
  }

  bool DropVideo() {
    queue_.Close();
    worker_->Join();
    return std::exchange(video_, nullptr) != nullptr;
  }

  [[nodiscard]] int left_out() const { return left_out_; }

 private:
  struct Item {
    RunViewContent content;
    int skipped_before = 0;
  };

  // What is wrong with the video, which is then removed and so makes room for the still; "" if it is in place.
  std::string FinishVideo() {
    try {
      if (video_ != nullptr) {
        video_->Finish();
      }
    } catch (const InputError& error) {
      video_.reset();
      return error.what();
    }
    return "";
  }

  void FinishStill() const {
    if (options_.still && !still_.empty()) {
      WriteFileAtomically(*options_.still, EncodePng(still_));
    } else if (options_.still) {
      throw InputError(fmt::format("{}: no picture, because the run did not reach frame {}", options_.still->string(),
                                   options_.still_frame ? options_.still_frame->value : 0));
    }
  }

  // The worker's function. An error closes the queue, so that Add does not wait for ever, and is thrown by Finish.
  void Work() {
    try {
      DrawAll();
    } catch (...) {
      queue_.Close();
      throw;
    }
  }

  void DrawAll() {
    Image8 picture;
    while (std::optional<Item> item = queue_.Pop()) {
      for (int i = 0; i < item->skipped_before && video_ != nullptr && !picture.empty(); ++i) {
        video_->Write(picture);
      }
      picture = view_.Draw(item->content);
      if (video_ != nullptr) {
        video_->Write(picture);
      }
      if (options_.still && (!options_.still_frame || *options_.still_frame == item->content.result.frame)) {
        still_ = picture;
      }
    }
  }

  const VideoOptions options_;
  int skipped_ = 0;  // since the last frame that was queued
  int left_out_ = 0;
  BoundedQueue<Item> queue_{kQueueCapacity};
  // Used by the worker until it is joined.
  RunView view_;
  std::unique_ptr<VideoFile> video_;
  Image8 still_;
  std::unique_ptr<Worker> worker_;  // last, so that it is joined before what it uses is destroyed
};

VideoRecorder::VideoRecorder(const VideoOptions& options, int image_width, int image_height)
    : impl_(std::make_unique<Impl>(options, image_width, image_height)) {}
VideoRecorder::~VideoRecorder() = default;
bool VideoRecorder::Wants(FrameId frame) const { return impl_->Wants(frame); }
void VideoRecorder::Add(RunViewContent content) { impl_->Add(std::move(content)); }
void VideoRecorder::Finish() { impl_->Finish(); }
bool VideoRecorder::DropVideo() { return impl_->DropVideo(); }
int VideoRecorder::left_out() const { return impl_->left_out(); }

}  // namespace rds
