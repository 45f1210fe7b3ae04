// What a run leaves behind as text: report.json, frames.csv, semantics.csv.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/playback.h"

namespace rds {

// How a run was asked for.
struct RunDescription {
  std::string sequence;   // name of the folder
  std::string segmenter;  // "none", or what Segmenter::Name says
  double rate = 1;
  bool lockstep = false;
  double started_after_s = 0;  // from the start of the process to the start of playing
};

// report.json without the accuracy: counts, times (median, mean, p95, max), memory, semantics. Times that were never
// measured are null.
[[nodiscard]] nlohmann::ordered_json RunReport(const RunDescription& description, const PlaybackResult& playback);

// CPU time in milliseconds a frame: of the whole program without reading images, of the tracking thread, of reading.
// `other_cpu_s` is taken off the first (a yardstick, drawing).
[[nodiscard]] nlohmann::ordered_json CpuReport(const PlaybackResult& playback, double other_cpu_s);

// Frames before the first pose: neither tracked nor lost.
[[nodiscard]] std::ptrdiff_t FramesNotStarted(const std::vector<FrameResult>& frames);

// One line a frame, with a heading.
[[nodiscard]] std::string FramesCsv(const PlaybackResult& playback);

// One line a label that arrived, with a heading.
[[nodiscard]] std::string SemanticsCsv(const std::vector<LabelEvent>& labels);

// A value of each frame's timing as a series.
[[nodiscard]] std::vector<double> TimingSeries(const std::vector<FrameResult>& frames, double FrameTiming::*member);

// "tracked", "lost" or "not_initialized".
[[nodiscard]] std::string ToString(TrackingState state);

}  // namespace rds
