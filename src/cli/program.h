// Parses a command line, runs what it says and turns what goes wrong into a message and an exit code.
#pragma once

#include <iosfwd>

namespace CLI {
class App;
}

namespace rds {

// Exit codes: 0 all well; 1 bad input or usage ("rds: error: ..."); 2 a bug; whatever CLI::RuntimeError asks for. An
// unknown command or option is answered with the nearest known one; no arguments at all with the help.
int RunProgram(CLI::App& app, int argc, const char* const* argv, std::ostream& out, std::ostream& error);

}  // namespace rds
