// SPDX-License-Identifier: Apache-2.0
#include "cli/suite_runner.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/sha256.h"
#include "base/text.h"
#include "base/time.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "io/atomic_file.h"
#include "io/dataset.h"

extern char** environ;  // NOLINT

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "/proc/self/exe";
constexpr const char* kDone = "done.txt";  // in the folder of a job: the command that it is the result of

void Append(std::vector<std::string>& words, std::initializer_list<std::string> more) {
  words.insert(words.end(), more);
}

// A command on some frames of a sequence.
std::vector<std::string> SequenceWords(const char* command, const SuiteSequence& sequence, const std::string& frames) {
  std::vector<std::string> words = {command, sequence.path.string(), "--frames", frames};
  if (!sequence.camera.empty()) {
    Append(words, {"--camera", sequence.camera});
  }
  return words;
}

fs::path MasksFolder(const fs::path& out, const SuiteSequence& sequence, const std::string& model) {
  return out / "masks" / AsFileName(sequence.name) / AsFileName(fs::path(model).filename().string());
}

std::vector<std::string> RunWords(const fs::path& out, const SuiteSequence& sequence,
                                  const SuiteConfiguration& configuration, const std::string& frames) {
  std::vector<std::string> words = SequenceWords("run", sequence, frames);
  Append(words, {"--segmenter", configuration.segmenter});
  if (!configuration.model.empty()) {
    Append(words, {"--model", configuration.model});
  }
  if (!configuration.masks_by.empty()) {
    Append(words, {"--masks", MasksFolder(out, sequence, configuration.masks_by).string()});
  }
  if (!configuration.preset.empty()) {
    Append(words, {"--preset", configuration.preset});
  }
  if (configuration.lockstep) {
    words.emplace_back("--lockstep");
  } else {
    Append(words, {"--rate", fmt::format("{:g}", configuration.rate)});
  }
  for (const std::string& assignment : configuration.set) {
    Append(words, {"--set", assignment});
  }
  return words;
}

// Frame N of the sequence's range, counted in all of the sequence.
std::string FramesUpTo(const SuiteSequence& sequence, int frame) {
  const FrameRange range = ParseFrameRange(sequence.frames);
  return fmt::format("{}:{}", range.begin, range.begin + static_cast<std::size_t>(frame) + 1);
}

SuiteJob MasksJob(const fs::path& out, const SuiteSequence& sequence, const std::string& model) {
  SuiteJob job{JobKind::kMasks, fmt::format("{}, masks by {}", sequence.name, model), MasksFolder(out, sequence, model),
               SequenceWords("segment", sequence, sequence.frames), 0};
  Append(job.arguments, {"--model", model, "--out", job.folder.string()});
  return job;
}

SuiteJob RunJob(const fs::path& out, const SuiteSequence& sequence, const SuiteConfiguration& configuration,
                int repetition, int repetitions, double recorded_s) {
  SuiteJob job{
      JobKind::kRun, fmt::format("{}, {}, {} of {}", sequence.name, configuration.name, repetition + 1, repetitions),
      RunFolder(out, sequence, configuration, repetition), RunWords(out, sequence, configuration, sequence.frames),
      configuration.lockstep ? 0 : recorded_s / configuration.rate};
  Append(job.arguments, {"--out", job.folder.string()});
  return job;
}

SuiteJob PictureJob(const fs::path& out, const SuiteSequence& sequence, const SuiteConfiguration& configuration,
                    int frame) {
  const fs::path file = PictureFile(out, sequence, configuration, frame);
  SuiteJob job{JobKind::kPicture, fmt::format("{}, {}, frame {}", sequence.name, configuration.name, frame),
               file.parent_path(), RunWords(out, sequence, configuration, FramesUpTo(sequence, frame)), 0};
  Append(job.arguments,
         {"--out", job.folder.string(), "--still", file.string(), "--still-frame", std::to_string(frame)});
  return job;
}

// Ends the process it is given when an interrupt comes, and waits for it.
int WaitFor(pid_t process, const std::function<void()>& on_wait) {
  bool ended = false;
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {
    if (Interrupted() && !std::exchange(ended, true)) {
      kill(process, SIGTERM);
    }
    on_wait();
    usleep(20'000);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Starts this program again, its words going to `log`.
pid_t Start(const std::vector<std::string>& arguments, const fs::path& log) {
  std::vector<std::string> words = {"rds"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> raw;
  std::ranges::transform(words, std::back_inserter(raw), [](std::string& word) { return word.data(); });
  raw.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t process = 0;
  const int error = posix_spawn(&process, kProgram, &actions, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw InputError(fmt::format("cannot start a run: {}", std::strerror(error)));
  }
  return process;
}

// The last line of a log, without the program's name for errors.
std::string WhyItFailed(const fs::path& log) {
  std::error_code error;
  const std::string text = fs::is_regular_file(log, error) ? ReadFile(log) : "";
  constexpr std::string_view kError = "rds: error: ";
  const std::string_view line = LastLine(text);
  return std::string(line.starts_with(kError) ? line.substr(kError.size()) : line);
}

// The command as the folder keeps it, with the program's digest: another build's results are no results of this one.
std::string CommandText(const SuiteJob& job, const std::string& program) {
  return fmt::format("{}\nprogram {}\n", fmt::join(job.arguments, "\n"), program);
}

bool IsThere(const SuiteJob& job, const std::string& program) {
  std::error_code error;
  return fs::is_regular_file(job.folder / kDone, error) && ReadFile(job.folder / kDone) == CommandText(job, program);
}

// "run 7 of 40: desk_walking, half width, 2 of 5; 12 s; 4:10 min left"
class SuiteProgress {
 public:
  explicit SuiteProgress(std::vector<double> expected_s) : expected_s_(std::move(expected_s)) {}

  void Begin(std::size_t index, const std::string& title) {
    index_ = index;
    title_ = title;
    begun_s_ = clock_.Seconds();
    Show();
  }
  void Update() {
    if (line_.terminal() ? line_.IsDue(clock_.Seconds()) : clock_.Seconds() - shown_s_ > 60) {
      Show();
    }
  }
  // Unknown durations are taken for the mean of those seen.
  void Done() {
    seen_s_ += clock_.Seconds() - begun_s_;
    ++seen_;
    expected_s_[index_] = 0;
  }

 private:
  void Show() {
    shown_s_ = clock_.Seconds();
    const double passed_s = shown_s_ - begun_s_;
    double left_s = 0;
    for (std::size_t i = index_; i < expected_s_.size(); ++i) {
      const double whole_s = expected_s_[i] > 0 ? expected_s_[i] : seen_ > 0 ? seen_s_ / static_cast<double>(seen_) : 0;
      left_s += i == index_ ? std::max(0.0, whole_s - passed_s) : whole_s;
    }
    line_.Show(shown_s_, fmt::format("{} of {}: {}; {}, {} left", index_ + 1, expected_s_.size(), title_,
                                     DurationText(passed_s), left_s > 0 ? DurationText(left_s) : "time unknown"));
  }

  std::vector<double> expected_s_;
  ProgressLine line_{std::cerr, isatty(STDERR_FILENO) == 1};
  Stopwatch clock_;
  std::size_t index_ = 0;
  std::string title_;
  double begun_s_ = 0;
  double shown_s_ = 0;
  double seen_s_ = 0;
  int seen_ = 0;
};

}  // namespace

fs::path RunFolder(const fs::path& out, const SuiteSequence& sequence, const SuiteConfiguration& configuration,
                   int repetition) {
  return out / "runs" / AsFileName(sequence.name) / AsFileName(configuration.name) / std::to_string(repetition + 1);
}

fs::path PictureFile(const fs::path& out, const SuiteSequence& sequence, const SuiteConfiguration& configuration,
                     int frame) {
  return out / "pictures" / AsFileName(sequence.name) / AsFileName(configuration.name) / std::to_string(frame) /
         "picture.png";
}

std::vector<SuiteJob> PlanSuite(const Suite& suite, const fs::path& out) {
  std::vector<SuiteJob> masks;
  std::vector<SuiteJob> runs;
  std::vector<SuiteJob> pictures;
  for (const SuiteSequence& sequence : suite.sequences) {
    const Dataset dataset = OpenSequence(sequence);
    const double recorded_s = dataset.frames().back().timestamp_s - dataset.frames().front().timestamp_s;
    for (const SuiteConfiguration& configuration : suite.configurations) {
      if (!configuration.masks_by.empty()) {
        SuiteJob job = MasksJob(out, sequence, configuration.masks_by);
        if (std::ranges::find(masks, job.folder, &SuiteJob::folder) == masks.end()) {
          masks.push_back(std::move(job));
        }
      }
      const int repetitions = configuration.lockstep ? 1 : suite.repetitions;  // lockstep repeats itself
      for (int i = 0; i < repetitions; ++i) {
        runs.push_back(RunJob(out, sequence, configuration, i, repetitions, recorded_s));
      }
      for (const int frame : suite.pictures) {
        if (static_cast<std::size_t>(frame) < dataset.size()) {
          pictures.push_back(PictureJob(out, sequence, configuration, frame));
        }
      }
    }
  }
  // One repetition of everything after the other: what is there early is of all, and slow drifts of a machine hit all.
  std::ranges::stable_sort(runs, {}, [](const SuiteJob& job) { return std::stoi(job.folder.filename().string()); });
  masks.insert(masks.end(), runs.begin(), runs.end());
  masks.insert(masks.end(), pictures.begin(), pictures.end());
  return masks;
}

SuiteOutcome RunSuite(const std::vector<SuiteJob>& jobs) {
  SuiteOutcome outcome;
  const std::string program = Sha256(kProgram);
  std::vector<const SuiteJob*> missing;
  std::vector<double> expected_s;
  for (const SuiteJob& job : jobs) {
    if (IsThere(job, program)) {
      ++outcome.there;
    } else {
      missing.push_back(&job);
      expected_s.push_back(job.expected_s);
    }
  }
  SuiteProgress progress(expected_s);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const SuiteJob& job = *missing[i];
    if (Interrupted()) {
      outcome.left = missing.size() - i;
      break;
    }
    PrepareOutputFolder(job.folder);
    std::error_code error;
    fs::remove(job.folder / kDone, error);
    progress.Begin(i, job.title);
    const int code = WaitFor(Start(job.arguments, job.folder / "log.txt"), [&] { progress.Update(); });
    if (Interrupted()) {
      outcome.left = missing.size() - i;
      break;
    }
    progress.Done();
    if (code != 0 && code != 3) {  // 3: nothing could be tracked, which is a result
      outcome.failures.push_back({job.title, WhyItFailed(job.folder / "log.txt"), (job.folder / "log.txt").string()});
      continue;
    }
    ++outcome.run;
    WriteFileAtomically(job.folder / kDone, CommandText(job, program));
  }
  return outcome;
}

}  // namespace rds
