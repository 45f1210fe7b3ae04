// SPDX-License-Identifier: Apache-2.0
// rds bench: tracking time against the reference, as JSON.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <memory>

#include "cli/bench_report.h"
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/observers.h"
#include "cli/play_arguments.h"
#include "cli/playback.h"
#include "cli/reference_timing.h"
#include "cli/series_json.h"

namespace rds {
namespace {

// Plays the sequence and prints the figures. Returns the exit code, as rds run does.
int Bench(const PlayArguments& arguments) {
  const InterruptGuard interrupt_guard;
  PlaySetup setup = PreparePlay(arguments, false);
  setup.play.strict = true;  // figures are those of all frames
  std::unique_ptr<Segmenter> segmenter = OpenSegmenter(arguments, setup);
  Progress progress(std::cerr, isatty(STDERR_FILENO) == 1, setup.dataset.size());
  ProgressObserver progress_observer(progress);
  ReferenceTiming reference_timing;
  const std::array<PlaybackObserver*, 2> observers = {&reference_timing, &progress_observer};
  const RunDescription description = Describe(setup, segmenter.get());
  const PlaybackResult playback =
      Play(setup.dataset, setup.camera, setup.options, std::move(segmenter), setup.play, observers);
  progress.Finish();
  RethrowError(playback);
  std::cout << BenchReport(description, playback, reference_timing.times_ms(), reference_timing.cpu_s())
                   .dump(2, ' ', false, kReplaceBadUtf8)
            << std::endl;
  return playback.interrupted ? 128 + InterruptSignal() : 0;
}

}  // namespace

void AddBenchCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "bench",
      "Measure tracking against a reference: OpenCV's ORB (1000 features, 8 levels, factor 1.2, one thread), timed on "
      "the same image just before each frame is tracked, so that figures of different machines compare. Prints JSON.");
  auto arguments = std::make_shared<PlayArguments>();
  AddPlayArguments(*command, *arguments, "none");
  command->add_option("--rate", arguments->rate, "Play so many times as fast as recorded; default 1")->type_name("R");
  command->callback([arguments] { EndCommand(Bench(*arguments)); });
}

}  // namespace rds
