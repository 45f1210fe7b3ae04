// SPDX-License-Identifier: Apache-2.0
// rds config: every option with its value, default, range and meaning.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/play_arguments.h"
#include "io/options_yaml.h"

namespace rds {

void AddConfigCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "config", "Print every option with its value, default, range and meaning, as YAML to be used with --config");
  auto arguments = std::make_shared<OptionArguments>();
  AddOptionArguments(*command, *arguments);
  command->callback([arguments] { std::cout << DocumentedOptionsYaml(ResolveOptions(*arguments)) << std::flush; });
}

}  // namespace rds
