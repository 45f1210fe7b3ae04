// SPDX-License-Identifier: Apache-2.0
// Runs what a suite asks for and is not there yet, each run a process and a folder of its own.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/suite.h"

namespace rds {

enum class JobKind { kMasks, kRun, kPicture };

// One command of this program.
struct SuiteJob {
  JobKind kind = JobKind::kRun;
  std::string title;             // "desk_walking, half width, 3 of 5"
  std::filesystem::path folder;  // that it writes to
  std::vector<std::string> arguments;
  double expected_s = 0;  // 0 = unknown
};

// All of a suite, in the order to run them: masks before what plays them back, then the first repetition of
// everything, the second, ...; pictures last. InputError where a sequence cannot be opened.
[[nodiscard]] std::vector<SuiteJob> PlanSuite(const Suite& suite, const std::filesystem::path& out);

// Where a run's results lie: OUT/runs/SEQUENCE/CONFIGURATION/N.
[[nodiscard]] std::filesystem::path RunFolder(const std::filesystem::path& out, const SuiteSequence& sequence,
                                              const SuiteConfiguration& configuration, int repetition);
// OUT/pictures/SEQUENCE/CONFIGURATION/FRAME/picture.png
[[nodiscard]] std::filesystem::path PictureFile(const std::filesystem::path& out, const SuiteSequence& sequence,
                                                const SuiteConfiguration& configuration, int frame);

struct SuiteFailure {
  std::string title;
  std::string why;
  std::string log;  // file
};

struct SuiteOutcome {
  std::size_t run = 0;                 // now
  std::size_t there = 0;               // from before
  std::size_t left = 0;                // not run, as it was interrupted
  std::vector<SuiteFailure> failures;  // the rest was run all the same
};

// Runs what is missing, with a progress display. A job is there where its folder holds what the same command of the
// same program (by its digest) left, complete; anything else is run anew. Stops after an interrupt (the run under way
// is ended, and is run again the next time). What a command says is in log.txt of its folder.
[[nodiscard]] SuiteOutcome RunSuite(const std::vector<SuiteJob>& jobs);

}  // namespace rds
