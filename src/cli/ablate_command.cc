// SPDX-License-Identifier: Apache-2.0
// rds ablate: what each part of the system is good for.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "base/error.h"
#include "base/log.h"
#include "base/suggest.h"
#include "cli/ablation.h"
#include "cli/accuracy.h"
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/play_arguments.h"
#include "cli/playback.h"
#include "cli/series_json.h"
#include "eval/statistics.h"

namespace rds {
namespace {

struct AblateArguments {
  PlayArguments play;
  std::vector<std::string> only;  // names of variants; empty = all
  bool json = false;
  bool markdown = false;
};

// The variants asked for, in the order of the list.
std::vector<AblationVariant> Select(const std::vector<std::string>& only) {
  const auto all = AblationVariants();
  std::vector<std::string> names;
  for (const AblationVariant& variant : all) {
    names.push_back(variant.name);
  }
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw InputError("--only " + name + ": no such variant" + Suggestion(name, names));
    }
  }
  std::vector<AblationVariant> selected;
  std::copy_if(all.begin(), all.end(), std::back_inserter(selected), [&only](const AblationVariant& variant) {
    return only.empty() || std::find(only.begin(), only.end(), variant.name) != only.end();
  });
  return selected;
}

AblationRow RowOf(const AblationVariant& variant, const PlaybackResult& playback,
                  const std::optional<Trajectory>& ground_truth) {
  AblationRow row;
  row.name = variant.name;
  row.meaning = variant.meaning;
  row.frames = playback.frames.size();
  row.tracked = playback.slam.tracked_frames;
  if (const std::optional<Evaluation> accuracy = Accuracy(playback.slam.frames, ground_truth)) {
    row.ate_rmse_m = accuracy->ate_m.rmse;
    if (accuracy->rpe_translation_m.count > 0) {
      row.rpe_rmse_m = accuracy->rpe_translation_m.rmse;
    }
  }
  row.keyframes = playback.slam.keyframes.size();
  row.labeled = playback.slam.labels.size();
  std::vector<double> delays;
  for (const FrameResult& frame : playback.frames) {
    if (frame.semantic_delay_frames) {
      delays.push_back(*frame.semantic_delay_frames);
    }
  }
  if (!delays.empty()) {
    row.delay_median_frames = Summarize(delays).median;
  }
  row.tracking_median_ms = Summarize(TimingSeries(playback.frames, &FrameTiming::total_ms)).median;
  return row;
}

PlaybackResult PlayVariant(const AblationVariant& variant, const PlayArguments& arguments, const PlaySetup& setup) {
  PlaySetup changed = setup;
  for (const std::string& assignment : variant.overrides) {
    SetOption(changed.options, assignment);
  }
  ValidateOptions(changed.options);
  std::unique_ptr<Segmenter> segmenter = variant.segmenter ? OpenSegmenter(arguments, changed) : nullptr;
  changed.play.strict = true;
  PlaybackResult playback =
      Play(changed.dataset, changed.camera, changed.options, std::move(segmenter), changed.play, {});
  RethrowError(playback);
  return playback;
}

// Plays the sequence in lockstep once for each variant and prints the table. Returns the exit code, as rds run does.
int Ablate(const AblateArguments& arguments) {
  const InterruptGuard interrupt_guard;
  const std::vector<AblationVariant> variants = Select(arguments.only);
  const PlaySetup setup = PreparePlay(arguments.play, true);
  std::vector<AblationRow> rows;
  for (const AblationVariant& variant : variants) {
    log::info("{} of {}: {} ({})", rows.size() + 1, variants.size(), variant.name, variant.meaning);
    const PlaybackResult playback = PlayVariant(variant, arguments.play, setup);
    if (playback.interrupted) {
      break;  // a row of half a sequence would mislead
    }
    rows.push_back(RowOf(variant, playback, setup.dataset.ground_truth()));
  }
  if (arguments.json) {
    std::cout << AblationJson(rows).dump(2, ' ', false, kReplaceBadUtf8) << std::endl;
  } else {
    std::cout << (arguments.markdown ? AblationMarkdown(rows) : AblationText(rows)) << std::flush;
  }
  return Interrupted() ? 128 + InterruptSignal() : 0;
}

}  // namespace

void AddAblateCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "ablate", "Run a sequence in lockstep with parts of the system switched off, and print what each is good for");
  auto arguments = std::make_shared<AblateArguments>();
  AddPlayArguments(*command, arguments->play, "stored");
  command->add_option("--only", arguments->only, "Only these variants, by name")
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  CLI::Option* json = command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--markdown", arguments->markdown, "Print a Markdown table")->excludes(json);
  command->callback([arguments] { EndCommand(Ablate(*arguments)); });
}

}  // namespace rds
