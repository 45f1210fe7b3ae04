// SPDX-License-Identifier: Apache-2.0
// Exceptions of the library: bad input (the user's to mend) and broken invariants (ours to mend).
#pragma once

#include <source_location>
#include <stdexcept>
#include <string>

namespace rds {

// Bad input: the message names the file, line or key and says what to do. Caught once, in main (exit code 1).
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A broken invariant of the program itself; thrown in every build, with its location.
class InvariantError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

// Throws InvariantError naming the caller's file and line if `condition` is false.
inline void Check(bool condition, const char* what, std::source_location where = std::source_location::current()) {
  if (condition) [[likely]] {
    return;
  }
  throw InvariantError(std::string(where.file_name()) + ":" + std::to_string(where.line()) + ": " + what);
}

}  // namespace rds
