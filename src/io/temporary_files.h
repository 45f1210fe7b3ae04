// Files under way: what a program that is ended at once must not leave behind.
#pragma once

#include <filesystem>

namespace rds {

// The name of a file that is to be removed unless it is moved into place: by the destructor, or by
// RemoveTemporaryFiles if the program is ended before. Makes no file itself.
class TemporaryPath {
 public:
  explicit TemporaryPath(std::filesystem::path path);
  ~TemporaryPath();
  TemporaryPath(TemporaryPath&& other) noexcept;
  TemporaryPath& operator=(TemporaryPath&&) = delete;
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  // Renames the file to `target`, which is replaced. Returns the number of the system's error, or 0.
  [[nodiscard]] int MoveTo(const std::filesystem::path& target);
  // Removes the file, if it is there.
  void Remove();
  // Leaves the file alone, now and later: it is somebody else's.
  void Disown();

 private:
  std::filesystem::path path_;  // empty once moved, removed or disowned
  int slot_;                    // in the table that RemoveTemporaryFiles reads; -1 = none
};

// Removes the file of every TemporaryPath. For a signal handler that ends the program right after: it does nothing but
// take pointers out of a table and call unlink.
void RemoveTemporaryFiles() noexcept;

}  // namespace rds
