// SPDX-License-Identifier: Apache-2.0
// rds: real-time RGB-D SLAM for dynamic scenes, on the command line.
#include <CLI/CLI.hpp>
#include <iostream>

#include "base/log.h"
#include "base/version.h"
#include "cli/command.h"
#include "cli/program.h"

namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  rds synth --out room                                a synthetic sequence to try things on\n"
    "  rds run room --out result                           track it; error, report and picture go to result/\n"
    "  rds run rgbd_dataset_freiburg3_walking_xyz --out result\n"
    "  rds run kitchen --camera redkitchen --set orb.features=1500 --out result\n"
    "  rds eval result/trajectory.txt room/groundtruth.txt --plot error.svg\n"
    "\n"
    "`rds COMMAND --help` tells more about each command, `rds config` about each option of the system.\n";

}  // namespace

int main(int argc, char** argv) {
  rds::OpenStandardStreams();
  CLI::App app("Real-time RGB-D SLAM for scenes in which people move.", "rds");
  app.set_version_flag("--version", std::string("rds ") + rds::kVersion, "Print the version and leave");
  bool verbose = false;
  app.add_flag("-v,--verbose", verbose, "Say more on standard error; before the command");
  app.parse_complete_callback([&verbose] { rds::log::SetUp(verbose); });
  app.require_subcommand(0, 1);
  app.footer(kExamples);
  rds::AddRunCommand(app);
  rds::AddEvalCommand(app);
  rds::AddBenchCommand(app);
  rds::AddAblateCommand(app);
  rds::AddSynthCommand(app);
  rds::AddEvaluateCommand(app);
  rds::AddSegmentCommand(app);
  rds::AddServeCommand(app);
  rds::AddFetchCommand(app);
  rds::AddConfigCommand(app);
  return rds::RunProgram(app, argc, argv, std::cout, std::cerr);
}
