// SPDX-License-Identifier: Apache-2.0
// rds run: a sequence in, trajectory, map figures and report out.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "base/sha256.h"
#include "cli/accuracy.h"
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/observers.h"
#include "cli/play_arguments.h"
#include "cli/playback.h"
#include "cli/progress.h"
#include "cli/run_identity.h"
#include "cli/run_report.h"
#include "cli/series_json.h"
#include "eval/plot.h"
#include "eval/statistics.h"
#include "io/atomic_file.h"
#include "io/options_yaml.h"
#include "io/trajectory_io.h"
#include "io/video.h"
#include "system/confidence_watch.h"

namespace rds {
namespace {

struct RunArguments {
  PlayArguments play;
  std::string out;
  bool lockstep = false;
  std::string video;  // "" = none
  std::string still;  // "" = none
  std::optional<std::uint32_t> still_frame;
};

VideoOptions VideoOf(const RunArguments& arguments, const PlaySetup& setup) {
  VideoOptions options;
  if (!arguments.video.empty()) {
    options.video = arguments.video;
  }
  if (!arguments.still.empty()) {
    options.still = arguments.still;
  } else if (arguments.still_frame) {
    throw InputError("--still-frame says which frame to save, but --still FILE.png is missing");
  }
  if (arguments.still_frame) {
    options.still_frame = FrameId{*arguments.still_frame};
    if (*arguments.still_frame >= setup.dataset.size()) {
      throw InputError(fmt::format("--still-frame {}: the sequence has only {} frames", *arguments.still_frame,
                                   setup.dataset.size()));
    }
  }
  if (const double interval_s = setup.dataset.MedianIntervalS(); interval_s > 0) {
    options.frames_per_s = std::clamp(1 / interval_s, 1.0, 120.0);
  }
  options.wait = setup.play.rate == 0 || setup.options.system.lockstep;
  return options;
}

// What was asked for and what came of it.
struct Outcome {
  RunDescription description;
  PlaybackResult playback;
  std::optional<Evaluation> accuracy;
};

// All that is text but the poses; adds to `files`, whose digests the report has.
void AddReports(const std::filesystem::path& folder, const PlaySetup& setup, const Outcome& outcome,
                std::vector<OutputFile>& files) {
  const std::string& run_id = outcome.description.run_id;
  files.push_back({folder / "options.yaml", OptionsYaml(setup.options) + "# run " + run_id + "\n"});
  files.push_back({folder / "frames.csv", FramesCsv(outcome.playback, run_id)});
  files.push_back({folder / "semantics.csv", SemanticsCsv(outcome.playback.slam.labels, run_id)});
  if (outcome.accuracy) {
    files.push_back({folder / "trajectory.svg", PlotTrajectories(*outcome.accuracy, outcome.description.sequence) +
                                                    "<!-- run " + run_id + " -->\n"});
  }
  nlohmann::ordered_json report = RunReport(outcome.description, outcome.playback);
  report.update(AccuracyJson(outcome.accuracy));
  for (const OutputFile& file : files) {
    report["files"][file.path.filename().string()] = Sha256OfText(file.text);
  }
  files.push_back({folder / "report.json", report.dump(2, ' ', false, kReplaceBadUtf8) + "\n"});
}

// Those of a run before, which had more worlds.
void RemoveWorldFiles(const std::filesystem::path& folder, const std::vector<OutputFile>& files) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_written = std::ranges::any_of(files, [&](const auto& file) { return file.path == entry.path(); });
    if (name.starts_with("trajectory.world-") && name.ends_with(".txt") && !is_written) {
      std::error_code error;
      if (!std::filesystem::remove(entry.path(), error)) {
        throw InputError(fmt::format("{}: cannot be removed: {}", entry.path().string(), error.message()));
      }
    }
  }
}

// The poses first: whatever goes wrong with a report, they are written.
void WriteOutputs(const std::filesystem::path& folder, const PlaySetup& setup, const Outcome& outcome) {
  std::vector<OutputFile> files = {
      {folder / "trajectory.txt", FormatTrajectory(outcome.playback.slam.frames)},
      {folder / "keyframes.txt", FormatTrajectory(outcome.playback.slam.keyframes)},
  };
  const std::vector<WorldTrajectory>& worlds = outcome.playback.slam.worlds;
  for (std::size_t i = 1; i < worlds.size(); ++i) {
    files.push_back({folder / WorldFileName(outcome.playback.slam, i), FormatTrajectory(worlds[i].frames)});
  }
  RemoveWorldFiles(folder, files);
  std::exception_ptr problem;
  try {
    AddReports(folder, setup, outcome, files);
  } catch (...) {
    problem = std::current_exception();
  }
  WriteFilesAtomically(files);
  std::error_code error;
  if (!outcome.accuracy && !std::filesystem::remove(folder / "trajectory.svg", error) && error) {  // of a run before
    throw InputError(fmt::format("{}: cannot be removed: {}", (folder / "trajectory.svg").string(), error.message()));
  }
  if (problem != nullptr) {
    std::rethrow_exception(problem);
  }
}

// How many frames were tracked and how well, or why none was.
std::string TrackingText(const PlaySetup& setup, const Outcome& outcome) {
  const SlamResult& slam = outcome.playback.slam;
  const std::ptrdiff_t not_started = FramesNotStarted(outcome.playback.frames);
  const std::string text =
      fmt::format("{}: {} of {} frames tracked{}, {} lost{}; {} keyframes, {} points\n", outcome.description.sequence,
                  slam.tracked_frames, outcome.playback.frames.size(),
                  slam.found_frames > 0 ? fmt::format(" ({} found at the end)", slam.found_frames) : "",
                  slam.lost_frames, not_started > 0 ? fmt::format(", {} before the start", not_started) : "",
                  slam.keyframes.size(), slam.map.points.size());
  if (slam.tracked_frames == 0) {
    return text + fmt::format(
                      "never started: no frame has the {} keypoints with depth that a start needs "
                      "(tracking.min_start_points); see that the images are not dark or blurred and that "
                      "depth has the scale of the camera file\n",
                      setup.options.tracking.min_start_points);
  }
  return text + AccuracyText(outcome.accuracy, slam.frames, setup.dataset.ground_truth());
}

// What happened to the map as a whole; "" if it is one world and no place was seen again.
std::string PlacesText(const SlamResult& slam) {
  std::vector<std::string> parts;
  const auto count = [&](SlamEventKind kind, std::string_view one, std::string_view many) {
    if (const std::ptrdiff_t times = CountEvents(slam, kind); times > 0) {
      parts.push_back(fmt::format("{} {}", times, times == 1 ? one : many));
    }
  };
  count(SlamEventKind::kRelocalized, "relocalization", "relocalizations");
  count(SlamEventKind::kLoopClosed, "loop closed", "loops closed");
  count(SlamEventKind::kWorldsMerged, "merge of worlds", "merges of worlds");
  std::string text = parts.empty() ? "" : fmt::format("places seen again: {}\n", fmt::join(parts, ", "));
  if (slam.worlds.size() > 1) {
    text += fmt::format(
        "the map fell apart into {} worlds; {:.1f} % of the frames since the start are in the largest, "
        "trajectory.txt; the others:",
        slam.worlds.size(), 100 * Coverage(slam));
    for (std::size_t i = 1; i < slam.worlds.size(); ++i) {
      text += fmt::format(" {} ({} frames)", WorldFileName(slam, i), slam.worlds[i].frames.size());
    }
    text += "\n";
  }
  return text;
}

// What went less well than the counts of TrackingText show; "" if nothing did.
std::string ConcernsText(const PlaybackResult& playback, double rate) {
  std::string text;
  if (const auto since = LostForGoodSince(playback.frames)) {
    text += fmt::format("lost since frame {} ({:.3f} s), {} frames to the end\n", playback.frames[*since].frame.value,
                        playback.frames[*since].timestamp_s, playback.frames.size() - *since);
  }
  if (playback.left_out > 0) {
    text += fmt::format("left out: {} frames that cannot be read; the first: {}\n", playback.left_out,
                        playback.first_problem);
  }
  if (const std::ptrdiff_t frames = UnexplainedFrames(playback.frames); frames > 0) {
    text += fmt::format(
        "unexplained: in {} frames the pose explains less than {:.0f} % of the depth image: much of what is seen "
        "moves, or "
        "the pose follows something that does (column confidence of frames.csv)\n",
        frames, 100 * kUnexplained);
  }
  if (const std::ptrdiff_t late = LateFrames(playback); late > 0) {
    text += fmt::format(
        "late: {} of {} frames began more than {:g} ms after they were due, by {:.2f} s at most: this "
        "machine is too slow for --rate {:g}\n",
        late, playback.frames.size(), kLate_ms, 1e-3 * std::ranges::max(playback.start_delay_ms), rate);
  }
  return text;
}

void PrintSummary(const RunArguments& arguments, const PlaySetup& setup, const Outcome& outcome) {
  const PlaybackResult& playback = outcome.playback;
  const SlamResult& slam = playback.slam;
  std::string text = TrackingText(setup, outcome) + PlacesText(slam) + ConcernsText(playback, setup.play.rate);
  const std::vector<double> tracking_ms = TimingSeries(playback.frames, &FrameTiming::total_ms);
  if (!tracking_ms.empty()) {
    text += fmt::format("tracking: {:.1f} ms a frame (median; 95 % below {:.1f} ms)\n", Summarize(tracking_ms).median,
                        Percentile(tracking_ms, 95));
  }
  if (outcome.description.segmenter != "none") {
    text += fmt::format("semantics: {}; {} keyframes labeled, {} left, {} failures\n", outcome.description.segmenter,
                        slam.labels.size(), slam.keyframes_left_unlabeled, slam.segmentation_failures);
  }
  text += fmt::format(
      "written to {}: trajectory.txt, keyframes.txt, report.json, frames.csv, semantics.csv, "
      "options.yaml{}\n",
      arguments.out, outcome.accuracy ? ", trajectory.svg" : "");
  std::cout << text << std::flush;
}

// Writes the output folder. Where that fails, the video under way may have filled the disk: it is given up for the
// results. Returns what to say of it, "" if nothing. Throws InputError if there is no room even so.
std::string WriteOutputsFirst(const RunArguments& arguments, const PlaySetup& setup, const Outcome& outcome,
                              VideoRecorder* recorder) {
  try {
    WriteOutputs(arguments.out, setup, outcome);
    return "";
  } catch (const InputError& error) {
    if (recorder == nullptr || !recorder->DropVideo()) {
      throw;
    }
    WriteOutputs(arguments.out, setup, outcome);
    return fmt::format("{}: the video is given up, to make room for the results ({})", arguments.video, error.what());
  }
}

// Completes video and still; `problems` are those of the video so far, "" if none. After an interruption what is
// missing is no error, but said.
void FinishRecording(VideoRecorder& recorder, std::string problems, bool interrupted) {
  try {
    recorder.Finish();
  } catch (const InputError& error) {
    problems += (problems.empty() ? "" : "; ") + std::string(error.what());
  }
  if (!problems.empty() && !interrupted) {
    throw InputError(problems);
  }
  if (!problems.empty()) {
    log::warn("{}", problems);
  }
  if (recorder.left_out() > 0) {
    log::info("the video repeats pictures for {} frames that could not be drawn in time", recorder.left_out());
  }
}

constexpr int kNothingTracked = 3;  // exit code

// Plays the sequence and writes the output folder. Returns the program's exit code: 0, kNothingTracked, or 128 + signal
// if interrupted. What was tracked is written in any case, also if an error ends the run, which is thrown afterwards;
// without any frame nothing is.
int Run(const RunArguments& arguments) {
  const InterruptGuard interrupt_guard;
  PlaySetup setup = PreparePlay(arguments.play, arguments.lockstep);
  PrepareOutputFolder(arguments.out);
  const VideoOptions video_options = VideoOf(arguments, setup);
  std::unique_ptr<VideoRecorder> recorder;
  if (video_options.Wanted()) {
    setup.options.system.keep_features = true;
    recorder = std::make_unique<VideoRecorder>(video_options, setup.camera.width, setup.camera.height);
  }
  std::unique_ptr<Segmenter> segmenter = OpenSegmenter(arguments.play, setup);
  log::info("{}", setup.dataset.Summary());
  log::info("camera: {} ({}), {} x {} pixels", setup.camera_name, setup.camera_reason, setup.camera.width,
            setup.camera.height);

  Progress progress(std::cerr, isatty(STDERR_FILENO) == 1, setup.dataset.size());
  ProgressObserver progress_observer(progress);
  std::vector<PlaybackObserver*> observers = {&progress_observer};
  std::unique_ptr<VideoObserver> video_observer;
  if (recorder != nullptr) {
    video_observer = std::make_unique<VideoObserver>(*recorder);
    observers.push_back(video_observer.get());
  }
  Outcome outcome;
  outcome.description = Describe(setup, segmenter.get());
  outcome.description.run_id = NewRunId();
  outcome.playback = Play(setup.dataset, setup.camera, setup.options, std::move(segmenter), setup.play, observers);
  progress.Finish();
  outcome.accuracy = Accuracy(outcome.playback.slam.frames, setup.dataset.ground_truth());
  std::string video_problem;
  if (outcome.playback.frames.empty()) {
    log::warn("no frame was processed; nothing is written to {}", arguments.out);
  } else {
    video_problem = WriteOutputsFirst(arguments, setup, outcome, recorder.get());
    PrintSummary(arguments, setup, outcome);
  }
  if (recorder != nullptr) {
    FinishRecording(*recorder, std::move(video_problem),
                    outcome.playback.interrupted || outcome.playback.error != nullptr);
  }
  if (outcome.playback.interrupted) {
    log::warn("stopped by a signal after {} of {} frames", outcome.playback.frames.size(), setup.dataset.size());
    return 128 + InterruptSignal();
  }
  RethrowError(outcome.playback);
  return outcome.playback.slam.tracked_frames > 0 ? 0 : kNothingTracked;
}

}  // namespace

void AddRunCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("run", "Track a recorded RGB-D sequence and write trajectory and report");
  auto arguments = std::make_shared<RunArguments>();
  AddPlayArguments(*command, arguments->play, "openvino");
  command->add_option("--out", arguments->out, "Folder for the results; made if it is not there")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--rate", arguments->play.rate,
                   "Play so many times as fast as recorded; 0 = as fast as it goes; default 1, in lockstep 0")
      ->type_name("R");
  command->add_flag("--strict", arguments->play.strict,
                    "End with an error at the first frame whose files cannot be read, instead of leaving it out");
  command->add_flag("--lockstep", arguments->lockstep,
                    "Everything on one thread in a fixed order: the same bytes every time");
  command
      ->add_option("--video", arguments->video,
                   "Video of frames with features (blue static, green unknown, red rejected), mask and map")
      ->type_name("FILE.mp4");
  command->add_option("--still", arguments->still, "One picture of that video: the last, or --still-frame")
      ->type_name("FILE.png");
  command->add_option("--still-frame", arguments->still_frame, "Which frame --still shows, from 0")->type_name("N");
  command->callback([arguments] { EndCommand(Run(*arguments)); });
}

}  // namespace rds
