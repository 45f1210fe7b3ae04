// SPDX-License-Identifier: Apache-2.0
// Video and still pictures of a run, drawn and encoded on a thread of their own.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "io/run_view.h"

namespace rds {

struct VideoOptions {
  std::optional<std::filesystem::path> video = std::nullopt;  // .mp4 (MPEG-4), played at frames_per_s
  std::optional<std::filesystem::path> still = std::nullopt;  // .png
  std::optional<FrameId> still_frame = std::nullopt;          // absent: the last frame
  double frames_per_s = 30;
  bool wait = false;  // Add waits for room instead of leaving a frame out (where real time is no matter)

  [[nodiscard]] bool Wanted() const { return video.has_value() || still.has_value(); }
};

// Takes frames from one thread; drawing and encoding happen on a worker behind a bounded queue. A frame that finds the
// queue full is left out and the picture before it shown twice, so the video keeps its time. Files appear under their
// names only when Finish succeeds; the destructor without Finish leaves nothing behind.
class VideoRecorder {
 public:
  // Throws InputError if a file cannot be written or the codec is missing.
  VideoRecorder(const VideoOptions& options, int image_width, int image_height);
  ~VideoRecorder();
  VideoRecorder(const VideoRecorder&) = delete;
  VideoRecorder& operator=(const VideoRecorder&) = delete;

  // Whether Add would use this frame; spares the caller the copies.
  [[nodiscard]] bool Wants(FrameId frame) const;
  // Never waits, unless VideoOptions::wait or the frame is the still.
  void Add(RunViewContent content);

  // Draws what is queued, closes the files and moves them into place, the video first. Throws InputError if a file is
  // incomplete (a full disk), if still_frame never came, or without any frame; the other file is in place all the same.
  void Finish();

  // Gives the video up and removes what there is of it, to make room on a full disk; the still stays wanted. False if
  // there was no video. Called after the last Add, instead of or before Finish.
  bool DropVideo();

  // Frames that found the queue full.
  [[nodiscard]] int left_out() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
