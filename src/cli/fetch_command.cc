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
  void Update(std::int64_t done, std::int64_t total) {
    const double now_s = clock_.Seconds();
    if (line_.IsDue(now_s) || done == total) {
      line_.Show(now_s, fmt::format("{:3} % of {:.1f} MB", 100 * done / total, 1e-6 * static_cast<double>(total)));
    }
  }

 private:
  ProgressLine line_{std::cerr, isatty(STDERR_FILENO) == 1};
  Stopwatch clock_;
};

}  // namespace

void Fetch(const FetchArguments& arguments) {
  if (arguments.what != "weights") {
    throw InputError(fmt::format("rds fetch: '{}' is unknown; there is: rds fetch weights [{}]", arguments.what,
                                 fmt::join(Names(), "|")));
  }
  const PublishedWeights& weights = WeightsOf(arguments.name.empty() ? "accurate" : arguments.name);
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
  CLI::App* command = program.add_subcommand("fetch",
                                             "Download what RDS needs but does not ship: the segmentation weights, "
                                             "DeepLabV3 by Google (Apache-2.0), named by\n"
                                             "commit and SHA-256. They go to $RDS_CACHE, else $XDG_CACHE_HOME/rds, "
                                             "else ~/.cache/rds. An interrupted download\n"
                                             "goes on where it stopped; a wrong digest is refused.");
  auto arguments = std::make_shared<FetchArguments>();
  std::string about;
  for (const PublishedWeights& weights : AllPublishedWeights()) {
    about += fmt::format("\n{}: {:.1f} MB, {}", weights.name, 1e-6 * static_cast<double>(weights.bytes), weights.about);
  }
  command->add_option("WHAT", arguments->what, "weights")->required();
  command->add_option("NAME", arguments->name, "Which; accurate if not given:" + about);
  command->add_option("--url-base", arguments->url_base,
                      "Fetch from this folder instead, a mirror (also: RDS_WEIGHTS_URL)");
  command->callback([arguments] { Fetch(*arguments); });
}

}  // namespace rds
