// SPDX-License-Identifier: Apache-2.0
// Parses a command line, runs what it says and turns what goes wrong into a message and an exit code.
#pragma once

#include <iosfwd>

namespace CLI {
class App;
}

namespace rds {

// Opens /dev/null in place of those of standard input, output and error that are closed, so that no file of ours gets
// their numbers and, with them, what is printed. Before anything else.
void OpenStandardStreams();

// Exit codes: 0 all well; 1 bad input or usage, or out of memory ("rds: error: ..."); 2 a bug; whatever
// CLI::RuntimeError asks for (rds run: 3 = nothing was tracked, 128 + signal = stopped by it). An
// unknown command or option is answered with the nearest known one; no arguments at all with the help.
int RunProgram(CLI::App& app, int argc, const char* const* argv, std::ostream& out, std::ostream& error);

}  // namespace rds
