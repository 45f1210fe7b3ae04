// SPDX-License-Identifier: Apache-2.0
#include "cli/run_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>

#include "base/error.h"
#include "cli/process_info.h"
#include "cli/run_identity.h"
#include "cli/series_json.h"
#include "eval/statistics.h"
#include "system/confidence_watch.h"

namespace rds {
namespace {

using Json = nlohmann::ordered_json;

Json LockJson(const LockSummary::Series& times) {
  return {{"median", times.median}, {"p95", times.p95}, {"max", times.max}};
}

std::vector<double> LabelSeries(const std::vector<LabelEvent>& labels, double LabelEvent::*member) {
  std::vector<double> values;
  std::transform(labels.begin(), labels.end(), std::back_inserter(values),
                 [member](const LabelEvent& label) { return label.*member; });
  return values;
}

Json SemanticReport(const RunDescription& description, const PlaybackResult& playback) {
  std::vector<double> delays;
  for (const FrameResult& frame : playback.frames) {
    if (frame.semantic_delay_frames) {
      delays.push_back(*frame.semantic_delay_frames);
    }
  }
  const SlamResult& slam = playback.slam;
  std::vector<double> optimization_ms = LabelSeries(slam.labels, &LabelEvent::optimization_ms);
  std::erase(optimization_ms, 0.0);  // none was due
  Json report;
  report["segmenter"] = description.segmenter;
  report["keyframes_labeled"] = slam.labels.size();
  report["keyframes_left_unlabeled"] = slam.keyframes_left_unlabeled;
  report["failures"] = slam.segmentation_failures;
  report["delay_frames"] = SeriesJson(delays);
  report["segmentation_ms"] = SeriesJson(LabelSeries(slam.labels, &LabelEvent::segmentation_ms));
  report["mask_ms"] = SeriesJson(LabelSeries(slam.labels, &LabelEvent::mask_ms));
  report["update_ms"] = SeriesJson(LabelSeries(slam.labels, &LabelEvent::update_ms));
  report["optimization_ms"] = SeriesJson(optimization_ms);
  report["static_points"] = slam.static_points;
  report["unknown_points"] = slam.unknown_points;
  report["dynamic_points"] = slam.dynamic_points;
  return report;
}

std::vector<double> Confidences(const std::vector<FrameResult>& frames) {
  std::vector<double> confidences;
  for (const FrameResult& frame : frames) {
    if (frame.confidence) {
      confidences.push_back(*frame.confidence);
    }
  }
  return confidences;
}

Json WorldsJson(const SlamResult& slam) {
  Json worlds = Json::array();
  for (std::size_t i = 0; i < slam.worlds.size(); ++i) {
    const WorldTrajectory& world = slam.worlds[i];
    worlds.push_back({{"world", world.world.value},
                      {"trajectory", WorldFileName(slam, i)},
                      {"frames", world.frames.size()},
                      {"keyframes", world.keyframes.size()}});
  }
  return worlds;
}

// Where points of one frame are in another: position in meters and quaternion, as in a trajectory.
Json PoseJson(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"translation_m", {t.x(), t.y(), t.z()}}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json EventsJson(const SlamResult& slam) {
  Json events = Json::array();
  for (const SlamEvent& event : slam.events) {
    Json json = {{"kind", ToString(event.kind)},
                 {"frame", event.frame.value},
                 {"timestamp_s", event.timestamp_s},
                 {"world", event.world.value}};
    if (event.kind == SlamEventKind::kWorldsMerged) {
      json["merged"] = event.merged.value;
    }
    if (event.kind == SlamEventKind::kWorldsMerged || event.kind == SlamEventKind::kLoopClosed) {
      json["into_from_from"] = PoseJson(event.into_from_from);
    }
    if (event.matches > 0) {
      json["matches"] = event.matches;
    }
    events.push_back(std::move(json));
  }
  return events;
}

// What ended the run early; null if nothing did.
Json ErrorText(const std::exception_ptr& error) {
  if (error == nullptr) {
    return nullptr;
  }
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& known) {
    return known.what();
  } catch (...) {
    return "an unknown error";
  }
}

}  // namespace

std::vector<double> TimingSeries(const std::vector<FrameResult>& frames, double FrameTiming::*member) {
  std::vector<double> values;
  std::transform(frames.begin(), frames.end(), std::back_inserter(values),
                 [member](const FrameResult& frame) { return frame.timing.*member; });
  return values;
}

std::string WorldFileName(const SlamResult& slam, std::size_t place) {
  return place == 0 ? "trajectory.txt" : fmt::format("trajectory.world-{}.txt", slam.worlds[place].world.value);
}

double Coverage(const SlamResult& slam) {
  const int frames = slam.tracked_frames + slam.lost_frames;
  return frames > 0 ? static_cast<double>(slam.frames.size()) / frames : 0;
}

std::ptrdiff_t CountEvents(const SlamResult& slam, SlamEventKind kind) {
  return std::ranges::count(slam.events, kind, &SlamEvent::kind);
}

std::ptrdiff_t FramesNotStarted(const std::vector<FrameResult>& frames) {
  return std::ranges::count(frames, TrackingState::kNotInitialized, &FrameResult::state);
}

std::optional<std::size_t> LostForGoodSince(const std::vector<FrameResult>& frames) {
  const auto tracked = std::find_if(frames.rbegin(), frames.rend(),
                                    [](const FrameResult& frame) { return frame.state != TrackingState::kLost; });
  const auto lost = static_cast<std::size_t>(tracked - frames.rbegin());
  return lost > 0 ? std::optional(frames.size() - lost) : std::nullopt;
}

std::ptrdiff_t UnexplainedFrames(const std::vector<FrameResult>& frames) {
  return std::ranges::count_if(frames,
                               [](const FrameResult& frame) { return frame.confidence.value_or(1) < kUnexplained; });
}

std::ptrdiff_t LateFrames(const PlaybackResult& playback) {
  return std::ranges::count_if(playback.start_delay_ms, [](double late_ms) { return late_ms > kLate_ms; });
}

Json CpuReport(const PlaybackResult& playback, double other_cpu_s) {
  if (playback.frames.empty()) {
    return nullptr;
  }
  const double per_frame_ms = 1e3 / static_cast<double>(playback.frames.size());
  Json report;
  report["all_threads"] = (playback.cpu_s - playback.reading_cpu_s - other_cpu_s) * per_frame_ms;
  report["tracking_thread"] = Summarize(TimingSeries(playback.frames, &FrameTiming::cpu_ms)).mean;
  report["reading_images"] = playback.reading_cpu_s * per_frame_ms;
  return report;
}

Json RunReport(const RunDescription& description, const PlaybackResult& playback) {
  const SlamResult& slam = playback.slam;
  Json report;
  report["run_id"] = description.run_id;
  report["sequence"] = description.sequence;
  report["input"] = description.input;
  report["camera"] = description.camera;
  report["versions"] = VersionsJson();
  report["rate"] = description.rate;
  report["lockstep"] = description.lockstep;
  report["interrupted"] = playback.interrupted;
  report["frames"] = playback.frames.size();
  report["tracked"] = slam.tracked_frames;
  report["lost"] = slam.lost_frames;
  report["found"] = slam.found_frames;
  report["not_started"] = FramesNotStarted(playback.frames);
  report["worlds"] = WorldsJson(slam);
  report["coverage"] = Coverage(slam);
  report["loops"] = CountEvents(slam, SlamEventKind::kLoopClosed);
  report["relocalizations"] = CountEvents(slam, SlamEventKind::kRelocalized);
  report["merges"] = CountEvents(slam, SlamEventKind::kWorldsMerged);
  report["events"] = EventsJson(slam);
  report["left_out"] = playback.left_out;
  report["first_left_out_because"] = playback.left_out > 0 ? Json(playback.first_problem) : Json(nullptr);
  const std::optional<std::size_t> lost_since = LostForGoodSince(playback.frames);
  report["lost_for_good_since_s"] = lost_since ? Json(playback.frames[*lost_since].timestamp_s) : Json(nullptr);
  report["error"] = ErrorText(playback.error);
  report["late"] = LateFrames(playback);
  report["confidence"] = SeriesJson(Confidences(playback.frames));
  report["unexplained_frames"] = UnexplainedFrames(playback.frames);
  report["keyframes"] = slam.keyframes.size();
  report["map_points"] = slam.map.points.size();
  report["start_up_s"] =
      playback.first_pose_after_s ? Json(description.started_after_s + *playback.first_pose_after_s) : Json(nullptr);
  report["tracking_ms"] = SeriesJson(TimingSeries(playback.frames, &FrameTiming::total_ms));
  report["tracking_parts_ms"] = {{"extraction", SeriesJson(TimingSeries(playback.frames, &FrameTiming::extraction_ms))},
                                 {"matching", SeriesJson(TimingSeries(playback.frames, &FrameTiming::matching_ms))},
                                 {"pose", SeriesJson(TimingSeries(playback.frames, &FrameTiming::pose_ms))},
                                 {"local_map", SeriesJson(TimingSeries(playback.frames, &FrameTiming::local_map_ms))}};
  report["cpu_ms_per_frame"] = CpuReport(playback, 0);
  report["local_ba_ms"] = SeriesJson(slam.local_ba_ms);
  report["map_lock_ms"] = {{"held", LockJson(slam.map_lock_ms.held)},
                           {"waited", LockJson(slam.map_lock_ms.waited)},
                           {"max_waited_by_tracking", slam.map_lock_ms.max_waited_by_tracking}};
  report["start_delay_ms"] = SeriesJson(playback.start_delay_ms);
  report["peak_memory_mb"] = PeakMemoryMb();
  report["wall_s"] = playback.wall_s;
  report["semantics"] = SemanticReport(description, playback);
  return report;
}

std::string FramesCsv(const PlaybackResult& playback, const std::string& run_id) {
  Check(playback.frames.size() == playback.start_delay_ms.size(), "a start delay for each frame");
  std::string csv =
      "frame,timestamp_s,state,total_ms,extraction_ms,matching_ms,pose_ms,local_map_ms,cpu_ms,static_matches,"
      "unknown_matches,rejected_matches,keyframe,confidence,semantic_delay_frames,start_delay_ms,run\n";
  for (std::size_t i = 0; i < playback.frames.size(); ++i) {
    const FrameResult& frame = playback.frames[i];
    const FrameTiming& timing = frame.timing;
    csv += fmt::format("{},{:.6f},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{},{},{},{},{},{},{:.3f},{}\n",
                       frame.frame.value, frame.timestamp_s, ToString(frame.state), timing.total_ms,
                       timing.extraction_ms, timing.matching_ms, timing.pose_ms, timing.local_map_ms, timing.cpu_ms,
                       frame.static_matches, frame.unknown_matches, frame.rejected_matches, frame.is_keyframe ? 1 : 0,
                       frame.confidence ? fmt::format("{:.3f}", *frame.confidence) : "",
                       frame.semantic_delay_frames ? std::to_string(*frame.semantic_delay_frames) : "",
                       playback.start_delay_ms[i], run_id);
  }
  return csv;
}

std::string SemanticsCsv(const std::vector<LabelEvent>& labels, const std::string& run_id) {
  std::string csv = "labeled_frame,current_frame,delay_frames,segmentation_ms,mask_ms,update_ms,optimization_ms,run\n";
  for (const LabelEvent& label : labels) {
    const auto delay =
        static_cast<std::int64_t>(label.current_frame.value) - static_cast<std::int64_t>(label.labeled_frame.value);
    csv +=
        fmt::format("{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{}\n", label.labeled_frame.value, label.current_frame.value,
                    delay, label.segmentation_ms, label.mask_ms, label.update_ms, label.optimization_ms, run_id);
  }
  return csv;
}

}  // namespace rds
