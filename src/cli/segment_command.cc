// SPDX-License-Identifier: Apache-2.0
// rds segment: a network's masks of a sequence, into files.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/log.h"
#include "base/time.h"
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/play_arguments.h"
#include "cli/progress_line.h"
#include "io/atomic_file.h"
#include "io/image_io.h"
#include "segmentation/segmenter.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

struct SegmentArguments {
  PlayArguments play;
  std::string out;
};

// The folder that masks go to: mask.txt and mask/TIME.png.
class MaskFolder {
 public:
  // Takes up what an earlier run by the same segmenter left. InputError where mask.txt is somebody else's.
  MaskFolder(fs::path folder, const std::string& segmenter)
      : folder_(std::move(folder)),
        heading_(
            fmt::format("{} {} (times in seconds; 255 dynamic, 128 unsure, 0 static)", kSegmentedMasks, segmenter)) {
    PrepareOutputFolder(folder_);
    PrepareOutputFolder(folder_ / "mask");
    std::error_code error;
    if (!fs::exists(List(), error)) {
      return;
    }
    const std::string text = ReadFile(List());
    if (!text.starts_with(kSegmentedMasks)) {
      throw InputError(List().string() + ": masks that `rds segment` did not write; choose another --out folder");
    }
    is_continued_ = text.starts_with(heading_ + "\n");
  }

  // Whether the mask is there from a run before.
  [[nodiscard]] bool Has(double timestamp_s) const {
    std::error_code error;
    return is_continued_ && fs::is_regular_file(folder_ / NameOf(timestamp_s), error);
  }
  void Add(double timestamp_s, const Image8& mask) {
    WriteFileAtomically(folder_ / NameOf(timestamp_s), EncodePng(mask));
  }
  void List(double timestamp_s) { rows_ += fmt::format("{:.6f} {}\n", timestamp_s, NameOf(timestamp_s)); }
  void WriteList() const { WriteFileAtomically(List(), heading_ + "\n" + rows_); }

 private:
  [[nodiscard]] fs::path List() const { return folder_ / "mask.txt"; }
  static std::string NameOf(double timestamp_s) { return fmt::format("mask/{:.6f}.png", timestamp_s); }

  const fs::path folder_;
  const std::string heading_;
  bool is_continued_ = false;
  std::string rows_;
};

Image8 MaskOf(Segmenter& segmenter, const Dataset& dataset, std::size_t index, const PinholeCamera& camera) {
  const RgbdFrame frame = dataset.Load(index, camera);
  const SegmentationInput input{FrameId{static_cast<std::uint32_t>(index)}, frame.timestamp_s, frame.image};
  std::vector<Image8> masks = segmenter.Segment({&input, 1});
  if (masks.size() != 1 || masks[0].empty()) {
    throw InputError(fmt::format("{}: the segmenter gave no mask", dataset.frames()[index].color_path.string()));
  }
  return std::move(masks[0]);
}

// Returns the exit code, as rds run does.
int Segment(const SegmentArguments& arguments) {
  const InterruptGuard interrupt_guard;
  if (arguments.play.segmenter == "none" || arguments.play.segmenter == "geometry") {
    throw InputError("--segmenter " + arguments.play.segmenter + " makes no masks of single images; choose another");
  }
  const PlaySetup setup = PreparePlay(arguments.play, true);
  const std::unique_ptr<Segmenter> segmenter = OpenSegmenter(arguments.play, setup);
  MaskFolder folder(arguments.out, segmenter->Name());
  std::exception_ptr problem;
  std::size_t made = 0;
  std::size_t listed = 0;
  {
    ProgressLine progress(std::cerr, isatty(STDERR_FILENO) == 1);
    const Stopwatch watch;
    try {
      for (std::size_t i = 0; i < setup.dataset.size() && !Interrupted(); ++i) {
        const double timestamp_s = setup.dataset.frames()[i].timestamp_s;
        if (!folder.Has(timestamp_s)) {
          folder.Add(timestamp_s, MaskOf(*segmenter, setup.dataset, i, setup.camera));
          ++made;
        }
        folder.List(timestamp_s);
        ++listed;
        if (const double now_s = watch.Seconds();
            made > 0 && (progress.IsDue(now_s) || listed == setup.dataset.size())) {
          const double each_s = now_s / static_cast<double>(made);
          progress.Show(
              now_s, fmt::format("{} of {} masks, {:.1f} a second, {} left", listed, setup.dataset.size(), 1 / each_s,
                                 DurationText(each_s * static_cast<double>(setup.dataset.size() - listed))));
        }
      }
    } catch (...) {
      problem = std::current_exception();
    }
  }
  if (listed > 0) {
    folder.WriteList();
  }
  if (problem != nullptr) {
    std::rethrow_exception(problem);
  }
  std::cout << fmt::format("{} masks, {} of them made now: {}\nnext: rds run {} --segmenter stored --masks {}\n",
                           listed, made, arguments.out, arguments.play.sequence, arguments.out)
            << std::flush;
  return Interrupted() ? 128 + InterruptSignal() : 0;
}

}  // namespace

void AddSegmentCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("segment",
                         "Write a segmenter's masks of a sequence to files, for --segmenter stored: a slow network is "
                         "run once, and played "
                         "back as often as wanted. What is there already from the same segmenter is kept.");
  auto arguments = std::make_shared<SegmentArguments>();
  AddPlayArguments(*command, arguments->play, "openvino");
  command
      ->add_option("--out", arguments->out,
                   "Folder for mask.txt and mask/; the sequence's own if it has none, else any other (--masks)")
      ->type_name("DIR")
      ->required();
  command->callback([arguments] { EndCommand(Segment(*arguments)); });
}

}  // namespace rds
