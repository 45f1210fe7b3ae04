// SPDX-License-Identifier: Apache-2.0
#include "cli/fetch_command.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/suggest.h"
#include "base/time.h"
#include "cli/progress_line.h"
#include "io/sequence_fetch.h"
#include "io/weights_fetch.h"
#include "segmentation/weights.h"

namespace rds {
namespace {

std::vector<std::string> Names() {
  std::vector<std::string> names;
  for (const PublishedWeights& weights : AllPublishedWeights()) {
    names.emplace_back(weights.name);
  }
  return names;
}

const PublishedWeights& WeightsOf(const std::string& name) {
  if (const PublishedWeights* const weights = FindPublishedWeights(name)) {
    return *weights;
  }
  throw InputError(fmt::format("weights '{}' are unknown{}; there are {}", name, Suggestion(name, Names()),
                               fmt::join(Names(), " and ")));
}

class FetchProgress {
 public:
  void Update(std::int64_t done, std::int64_t total, const char* what = "") {
    const double now_s = clock_.Seconds();
    if (line_.IsDue(now_s) || done == total) {
      line_.Show(now_s,
                 fmt::format("{}{:3} % of {:.1f} MB", what, 100 * done / total, 1e-6 * static_cast<double>(total)));
    }
  }

 private:
  ProgressLine line_{std::cerr, isatty(STDERR_FILENO) == 1};
  Stopwatch clock_;
};

void FetchSequences(const Benchmark& benchmark, const FetchArguments& arguments) {
  const std::string url = arguments.url_base.empty() ? benchmark.url : arguments.url_base;
  std::vector<PublishedSequence> sequences;
  for (const std::string& name : arguments.names.empty() ? benchmark.usual : arguments.names) {
    sequences.push_back(FindSequence(benchmark, name));
  }
  std::size_t number = 0;
  for (const PublishedSequence& sequence : sequences) {
    std::cerr << fmt::format("{} of {}: {} from {}\n", ++number, sequences.size(), sequence.name, url);
    std::string folder;
    {
      FetchProgress progress;
      folder =
          FetchSequence(sequence, arguments.out, url, [&](FetchStage stage, std::int64_t done, std::int64_t total) {
            progress.Update(done, total,
                            stage == FetchStage::kDownloading ? ""
                            : stage == FetchStage::kUnpacking ? "unpacking "
                                                              : "checking ");
          }).string();
    }
    std::cout << folder << "\n" << std::flush;
  }
}

}  // namespace

void Fetch(const FetchArguments& arguments) {
  for (const Benchmark& benchmark : Benchmarks()) {
    if (arguments.what == benchmark.name) {
      FetchSequences(benchmark, arguments);
      return;
    }
  }
  if (arguments.what != "weights") {
    throw InputError(
        fmt::format("rds fetch: '{}' is unknown; there are: rds fetch weights [{}], rds fetch tum [NAME ...], "
                    "rds fetch bonn [NAME ...]",
                    arguments.what, fmt::join(Names(), "|")));
  }
  if (arguments.names.size() > 1) {
    throw InputError("rds fetch weights: one name at a time");
  }
  const PublishedWeights& weights = WeightsOf(arguments.names.empty() ? "accurate" : arguments.names.front());
  const std::string url = arguments.url_base.empty() ? WeightsUrl() : arguments.url_base;
  std::string file;
  {
    std::cerr << fmt::format("{} ({}) from {}\n", weights.file, weights.name, url);
    FetchProgress progress;
    file = FetchWeights(weights, CacheFolder(), url, [&](std::int64_t done, std::int64_t total) {
             progress.Update(done, total);
           }).string();
  }
  std::cerr << fmt::format("verified (SHA-256); `rds run` finds it there, --model {} names it\n", weights.name);
  std::cout << file << "\n" << std::flush;
}

void AddFetchCommand(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("fetch",
                             "Download what RDS needs but does not ship.\n"
                             "rds fetch weights [NAME]: the segmentation weights, DeepLabV3 by Google (Apache-2.0), "
                             "named by commit and SHA-256. "
                             "They go to $RDS_CACHE, else $XDG_CACHE_HOME/rds, else ~/.cache/rds.\n"
                             "rds fetch tum [NAME ...], rds fetch bonn [NAME ...]: sequences of the RGB-D benchmarks, "
                             "from their own addresses, "
                             "unpacked into --out; without a name, those of the paper, or a few of Bonn's.\n"
                             "An interrupted download goes on where it stopped; what came is checked.");
  auto arguments = std::make_shared<FetchArguments>();
  std::string about;
  for (const PublishedWeights& weights : AllPublishedWeights()) {
    about += fmt::format("\n{}: {:.1f} MB, {}", weights.name, 1e-6 * static_cast<double>(weights.bytes), weights.about);
  }
  command->add_option("WHAT", arguments->what, "weights, tum or bonn")->required();
  command->add_option("NAME", arguments->names,
                      "Which. Of tum and bonn the folders' names, or those without their beginning: walking_xyz, "
                      "fr1/desk, balloon. Of weights; accurate if not given:" +
                          about);
  command->add_option("--out", arguments->out, "Folder for sequences; default: this one")->type_name("DIR");
  command->add_option("--url-base", arguments->url_base,
                      "Fetch from this folder instead, a mirror (of weights also: RDS_WEIGHTS_URL)");
  command->callback([arguments] { Fetch(*arguments); });
}

}  // namespace rds
