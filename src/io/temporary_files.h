// SPDX-License-Identifier: Apache-2.0
// Files under way: what a program that is ended at once must not leave behind.
#pragma once

#include <filesystem>

#include "base/error.h"

namespace rds {

// A new empty file beside `target`, hidden, with a name that nobody can guess and the target's extension. Removed
// unless it is moved into place: by the destructor; by RemoveTemporaryFiles if the program is ended before; if it is
// killed, by RemoveAbandonedFiles of a later run, which tells by a lock that its owner is dead.
class TemporaryPath {
 public:
  // Throws InputError, naming the target, if the file cannot be made.
  explicit TemporaryPath(const std::filesystem::path& target);
  ~TemporaryPath();
  TemporaryPath(TemporaryPath&& other) noexcept;
  TemporaryPath& operator=(TemporaryPath&&) = delete;
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  // Open for writing, and closed by the destructor.
  [[nodiscard]] int file() const { return file_; }

  // Renames the file to `target`, which is replaced. Returns the number of the system's error, or 0.
  [[nodiscard]] int MoveTo(const std::filesystem::path& target);
  // Removes the file, if it is there.
  void Remove();

 private:
  void Disown();

  std::filesystem::path path_;  // empty once moved or removed
  int file_ = -1;
  int slot_ = -1;  // in the table that RemoveTemporaryFiles reads; -1 = none
};

// "PATH: cannot be written: ...", with what to do; `error` as errno has it.
[[nodiscard]] InputError CannotWrite(const std::filesystem::path& path, int error);

// Removes the temporary files in a folder whose program has been killed. What cannot be read or removed is left alone.
void RemoveAbandonedFiles(const std::filesystem::path& folder);

// Removes the file of every TemporaryPath. For a signal handler that ends the program right after: it does nothing but
// take pointers out of a table and call unlink.
void RemoveTemporaryFiles() noexcept;

}  // namespace rds
