// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <exception>
#include <new>
#include <ostream>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/suggest.h"

namespace rds {
namespace {

// The command that was named, or the program itself.
const CLI::App& Active(const CLI::App& app) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  return commands.empty() ? app : *commands.front();
}

std::string HelpHint(const CLI::App& app) {
  const CLI::App& active = Active(app);
  return "see `" + app.get_name() + (&active == &app ? "" : " " + active.get_name()) + " --help`";
}

std::vector<std::string> OptionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  return names;
}

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

// What to say about an argument that the program (or the command, if `is_command`) does not know.
std::string DescribeUnknown(const CLI::App& app, bool is_command, const std::string& argument) {
  if (argument.starts_with("-")) {
    const std::string name = argument.substr(0, argument.find('='));
    return "unknown option '" + name + "'" + Suggestion(name, OptionNames(app));
  }
  return is_command ? "unexpected argument '" + argument + "'"
                    : "unknown command '" + argument + "'" + Suggestion(argument, CommandNames(app));
}

// The name of an option that was given more often than it may be, or "".
std::string GivenTwice(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw && option->get_items_expected_max() > 0 &&
        option->count() > static_cast<std::size_t>(option->get_items_expected_max())) {
      return option->get_name();
    }
  }
  return "";
}

// CLI11 complains of a missing argument before an unknown one; but it is the mistyped word that wants mending.
std::string DescribeUsageError(const CLI::App& app, const CLI::ParseError& parse_error) {
  const CLI::App& active = Active(app);
  std::string what = parse_error.what();
  if (const std::vector<std::string> unknown = app.remaining(); !unknown.empty()) {
    what = DescribeUnknown(app, false, unknown.front());
  } else if (const std::vector<std::string> extra = active.remaining(); !extra.empty()) {
    const auto option = std::find_if(extra.begin(), extra.end(), [](const auto& e) { return e.starts_with("-"); });
    what = DescribeUnknown(active, true, option == extra.end() ? extra.front() : *option);
  } else if (const std::string option = GivenTwice(active); !option.empty()) {
    what = option + " is given more than once";
  }
  return what + "; " + HelpHint(app);
}

int ParseAndRun(CLI::App& app, int argc, const char* const* argv, std::ostream& out, std::ostream& error) {
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      out << app.help();
    }
    return 0;
  } catch (const CLI::RuntimeError& exit) {
    return exit.get_exit_code();
  } catch (const CLI::ParseError& parse_error) {
    if (parse_error.get_exit_code() == 0) {  // --help, --version
      return app.exit(parse_error, out, error);
    }
    error << "rds: error: " << DescribeUsageError(app, parse_error) << "\n";
    return 1;
  }
}

}  // namespace

void OpenStandardStreams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(number, F_GETFD) == -1 && errno == EBADF) {
      open("/dev/null",
           number == STDIN_FILENO ? O_RDONLY : O_WRONLY);  // takes the lowest number that is free: this one
    }
  }
}

int RunProgram(CLI::App& app, int argc, const char* const* argv, std::ostream& out, std::ostream& error) {
  try {
    const int code = ParseAndRun(app, argc, argv, out, error);
    out.flush();
    if (!out) {
      error << "rds: error: standard output cannot be written (is the disk full?)\n";
      return 1;
    }
    return code;
  } catch (const InputError& input_error) {
    error << "rds: error: " << input_error.what() << "\n";
    return 1;
  } catch (const std::bad_alloc&) {
    error << "rds: error: out of memory; use smaller images, fewer features (orb.features) or a shorter part of the "
             "sequence (--frames)\n";
    return 1;
  } catch (const std::exception& bug) {
    if (const auto* system = dynamic_cast<const std::system_error*>(&bug);
        system != nullptr && system->code() == std::errc::resource_unavailable_try_again) {
      error << "rds: error: no thread can be started; allow more processes (ulimit -u) or memory\n";
      return 1;
    }
    error << "rds: bug: " << bug.what() << "\nThis should not happen, whatever the input; please report it.\n";
    return 2;
  }
}

}  // namespace rds
