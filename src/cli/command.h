// SPDX-License-Identifier: Apache-2.0
// The program's commands, each in a file of its own: adds a subcommand whose callback does the work once all of the
// command line is parsed. Callbacks throw InputError, or end with another exit code by CLI::RuntimeError.
#pragma once

namespace CLI {
class App;
}

namespace rds {

void AddRunCommand(CLI::App& app);
void AddEvalCommand(CLI::App& app);
void AddBenchCommand(CLI::App& app);
void AddAblateCommand(CLI::App& app);
void AddSynthCommand(CLI::App& app);
void AddEvaluateCommand(CLI::App& app);
void AddSegmentCommand(CLI::App& app);
void AddServeCommand(CLI::App& app);
void AddFetchCommand(CLI::App& app);
void AddConfigCommand(CLI::App& app);

}  // namespace rds
