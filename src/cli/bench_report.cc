// SPDX-License-Identifier: Apache-2.0
#include "cli/bench_report.h"

#include <algorithm>
#include <span>

#include "base/error.h"
#include "cli/process_info.h"
#include "cli/series_json.h"
#include "eval/statistics.h"

namespace rds {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kGrowthFrames = 250;

// Null where there is nothing to divide by.
Json Ratio(double numerator, double denominator) {
  return denominator > 0 ? Json(numerator / denominator) : Json(nullptr);
}

Json Growth(const std::vector<double>& tracking_ms) {
  const std::size_t count = std::min(kGrowthFrames, tracking_ms.size() / 2);
  if (count == 0) {
    return nullptr;
  }
  const std::span<const double> all(tracking_ms);
  const double first = Summarize(all.first(count)).median;
  const double last = Summarize(all.last(count)).median;
  return {{"frames", count}, {"first_ms", first}, {"last_ms", last}, {"ratio", Ratio(last, first)}};
}

// Parts of the mean tracking time.
Json Shares(const std::vector<FrameResult>& frames) {
  const auto mean = [&frames](double FrameTiming::*member) { return Summarize(TimingSeries(frames, member)).mean; };
  const double total = mean(&FrameTiming::total_ms);
  const double extraction = mean(&FrameTiming::extraction_ms);
  const double matching = mean(&FrameTiming::matching_ms);
  const double pose = mean(&FrameTiming::pose_ms);
  const double local_map = mean(&FrameTiming::local_map_ms);
  return {{"extraction", Ratio(extraction, total)},
          {"matching", Ratio(matching, total)},
          {"pose", Ratio(pose, total)},
          {"local_map", Ratio(local_map, total)},
          {"other", Ratio(total - extraction - matching - pose - local_map, total)}};
}

}  // namespace

Json BenchReport(const RunDescription& description, const PlaybackResult& playback,
                 const std::vector<double>& reference_ms, double reference_cpu_s) {
  Check(reference_ms.size() == playback.frames.size(), "a reference time for each frame");
  const std::vector<double> tracking_ms = TimingSeries(playback.frames, &FrameTiming::total_ms);
  Json report;
  report["sequence"] = description.sequence;
  report["segmenter"] = description.segmenter;
  report["rate"] = description.rate;
  report["frames"] = playback.frames.size();
  report["tracked"] = playback.slam.tracked_frames;
  report["reference_ms"] = SeriesJson(reference_ms);
  report["tracking_ms"] = SeriesJson(tracking_ms);
  report["ratio"] = Ratio(Summarize(tracking_ms).median, Summarize(reference_ms).median);
  report["shares"] = Shares(playback.frames);
  report["growth"] = Growth(tracking_ms);
  report["cpu_ms_per_frame"] = CpuReport(playback, reference_cpu_s);
  report["start_delay_ms"] = SeriesJson(playback.start_delay_ms);
  report["peak_memory_mb"] = PeakMemoryMb();
  report["interrupted"] = playback.interrupted;
  return report;
}

}  // namespace rds
