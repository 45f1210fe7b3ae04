// SPDX-License-Identifier: Apache-2.0
// rds evaluate: a suite of runs, and their report.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/play_arguments.h"
#include "cli/suite.h"
#include "cli/suite_report.h"
#include "cli/suite_results.h"
#include "cli/suite_runner.h"
#include "io/atomic_file.h"

namespace rds {
namespace {

struct EvaluateArguments {
  std::string suite;
  std::string out;
  std::string data;
  std::optional<int> repetitions;
  bool report_only = false;
};

// What failed in one way is said once.
std::vector<std::string> ProblemsOf(const SuiteOutcome& outcome) {
  std::map<std::string, std::vector<const SuiteFailure*>> by_reason;
  for (const SuiteFailure& failure : outcome.failures) {
    by_reason[failure.why].push_back(&failure);
  }
  std::vector<std::string> problems;
  for (const auto& [why, failures] : by_reason) {
    problems.push_back(fmt::format("{}{}: {} (log: {})", failures[0]->title,
                                   failures.size() > 1 ? fmt::format(" and {} more", failures.size() - 1) : "", why,
                                   failures[0]->log));
  }
  return problems;
}

// Returns the exit code: 0 all well, 1 where a run failed, 128 + signal after an interrupt; there is a report in any
// case.
int EvaluateSuite(const EvaluateArguments& arguments) {
  const InterruptGuard interrupt_guard;
  Suite suite = ReadSuite(arguments.suite, arguments.data);
  suite.repetitions = arguments.repetitions.value_or(suite.repetitions);
  const std::filesystem::path out = std::filesystem::absolute(arguments.out);
  PrepareOutputFolder(out);
  SuiteOutcome outcome;
  if (!arguments.report_only) {
    outcome = RunSuite(PlanSuite(suite, out));
  }
  std::vector<std::string> problems = ProblemsOf(outcome);
  if (outcome.left > 0) {
    problems.push_back(fmt::format("{} runs are missing; the same command goes on", outcome.left));
  }
  WriteSuiteReport(suite, ReadResults(suite, out), problems, out);
  std::cout << fmt::format("{} runs made, {} were there\nreport: {}\n", outcome.run, outcome.there,
                           (out / "report.html").string());
  for (const std::string& problem : problems) {
    std::cerr << "rds: error: " << problem << "\n";
  }
  return Interrupted() ? 128 + InterruptSignal() : problems.empty() ? 0 : 1;
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Run all that a suite names (sequences, configurations, repetitions), each in a folder of its own, and write a "
      "report with tables and plots: report.html, report.md, *.csv. What is there from before is not run again.");
  auto arguments = std::make_shared<EvaluateArguments>();
  command
      ->add_option("suite", arguments->suite,
                   "Suite, such as evaluation/paper.yaml; evaluation/README.md tells how to write one")
      ->type_name("SUITE.yaml")
      ->required();
  command->add_option("--out", arguments->out, "Folder for runs and report; made if it is not there")
      ->type_name("DIR")
      ->required();
  command->add_option("--data", arguments->data, "Folder that the suite's paths start from, instead of the suite's own")
      ->type_name("DIR");
  command->add_option("--repetitions", arguments->repetitions, "Instead of the suite's")
      ->type_name("N")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--report-only", arguments->report_only, "Run nothing; write the report of what is there");
  command->callback([arguments] { EndCommand(EvaluateSuite(*arguments)); });
}

}  // namespace rds
