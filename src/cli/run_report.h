// SPDX-License-Identifier: Apache-2.0
// What a run leaves behind as text: report.json, frames.csv, semantics.csv.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/playback.h"

namespace rds {

// How a run was asked for.
struct RunDescription {
  std::string sequence;   // name of the folder
  std::string segmenter;  // "none", or what Segmenter::Name says
  double rate = 1;
  bool lockstep = false;
  double started_after_s = 0;  // from the start of the process to the start of playing
  std::string run_id;          // of NewRunId
  nlohmann::ordered_json camera;
  nlohmann::ordered_json input;
};

// report.json without the accuracy: counts, times (median, mean, p95, max), memory, semantics. Times that were never
// measured are null.
[[nodiscard]] nlohmann::ordered_json RunReport(const RunDescription& description, const PlaybackResult& playback);

// CPU time in milliseconds a frame: of the whole program without reading images, of the tracking thread, of reading.
// `other_cpu_s` is taken off the first (a reference, drawing).
[[nodiscard]] nlohmann::ordered_json CpuReport(const PlaybackResult& playback, double other_cpu_s);

// The frame from which on tracking was lost to the end, if it was: its place among those processed.
[[nodiscard]] std::optional<std::size_t> LostForGoodSince(const std::vector<FrameResult>& frames);

// Frames tracked whose pose is in doubt (kUnexplained).
[[nodiscard]] std::ptrdiff_t UnexplainedFrames(const std::vector<FrameResult>& frames);

// Frames begun later than that after they were due are late, in milliseconds.
inline constexpr double kLate_ms = 10;
[[nodiscard]] std::ptrdiff_t LateFrames(const PlaybackResult& playback);

// The file with the poses of a world, by its place in SlamResult::worlds: trajectory.txt, trajectory.world-N.txt.
[[nodiscard]] std::string WorldFileName(const SlamResult& slam, std::size_t place);

// Share, 0 to 1, of the frames since the first pose that have one in the largest world.
[[nodiscard]] double Coverage(const SlamResult& slam);

[[nodiscard]] std::ptrdiff_t CountEvents(const SlamResult& slam, SlamEventKind kind);

// Frames before the first pose: neither tracked nor lost.
[[nodiscard]] std::ptrdiff_t FramesNotStarted(const std::vector<FrameResult>& frames);

// One line a frame, with a heading.
[[nodiscard]] std::string FramesCsv(const PlaybackResult& playback, const std::string& run_id);

// One line a label that arrived, with a heading.
[[nodiscard]] std::string SemanticsCsv(const std::vector<LabelEvent>& labels, const std::string& run_id);

// A value of each frame's timing as a series.
[[nodiscard]] std::vector<double> TimingSeries(const std::vector<FrameResult>& frames, double FrameTiming::*member);

}  // namespace rds
