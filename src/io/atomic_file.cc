// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/temporary_files.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// Writes all of the text; the number of the system's error, or 0.
int WriteAll(int file, std::string_view text, bool sync) {
  while (!text.empty()) {
    const ssize_t count = write(file, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return sync && fsync(file) != 0 ? errno : 0;
}

// For /dev/stdout and the like, which must not be replaced by a file.
void WriteStraight(const fs::path& path, std::string_view text) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe that nobody reads: an error
  int error = file < 0 ? errno : 0;
  if (file >= 0) {
    fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
    error = WriteAll(file, text, false);
    error = close(file) != 0 && error == 0 ? errno : error;
  }
  if (error != 0) {
    throw CannotWrite(path, error);
  }
}

// A link that somebody else made may lead anywhere. Ours, and root's, are meant.
void RefuseForeignLinks(const fs::path& path) {
  fs::path walked;
  for (const fs::path& part : fs::absolute(path)) {
    walked /= part;
    struct stat status {};
    if (lstat(walked.c_str(), &status) == 0 && S_ISLNK(status.st_mode) && status.st_uid != geteuid() &&
        status.st_uid != 0) {
      throw InputError(fmt::format("{}: not written: {} is a link that another user made; choose another place",
                                   path.string(), walked.string()));
    }
  }
}

// The regular file to replace: what a link points to, so that a link stays a link. Nothing for a device.
std::optional<fs::path> FileToReplace(const fs::path& path) {
  RefuseForeignLinks(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    throw CannotWrite(path, EISDIR);
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return std::nullopt;
  }
  return fs::is_symlink(fs::symlink_status(path, ignored)) ? fs::weakly_canonical(path) : path;
}

}  // namespace

void WriteFilesAtomically(std::span<const OutputFile> files) {
  std::vector<std::pair<TemporaryPath, fs::path>> temporary;
  std::vector<const OutputFile*> straight;
  for (const OutputFile& file : files) {
    const std::optional<fs::path> target = FileToReplace(file.path);
    if (!target) {
      straight.push_back(&file);
      continue;
    }
    const TemporaryPath& made = temporary.emplace_back(TemporaryPath(*target), *target).first;
    if (const int error = WriteAll(made.file(), file.text, true); error != 0) {
      throw CannotWrite(file.path, error);
    }
  }
  for (const OutputFile* file : straight) {
    WriteStraight(file->path, file->text);
  }
  for (auto& [made, target] : temporary) {
    if (const int error = made.MoveTo(target); error != 0) {
      throw CannotWrite(target, error);
    }
  }
}

void WriteFileAtomically(const fs::path& path, std::string_view text) {
  const OutputFile file{path, std::string(text)};
  WriteFilesAtomically({&file, 1});
}

void CheckWritable(const fs::path& path) {
  if (const std::optional<fs::path> target = FileToReplace(path)) {
    RemoveAbandonedFiles(target->parent_path());
    const TemporaryPath trial(*target);
    if (const int error = WriteAll(trial.file(), "\n", true); error != 0) {
      throw CannotWrite(path, error);
    }
  }
}

void PrepareOutputFolder(const fs::path& folder) {
  RefuseForeignLinks(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw InputError(
        fmt::format("{}: output folder cannot be made: {}", folder.string(), error ? error.message() : "not a folder"));
  }
  RemoveAbandonedFiles(folder);
  try {
    const TemporaryPath trial(folder / "trial");
    if (const int reason = WriteAll(trial.file(), std::string(4096, '\n'), true); reason != 0) {
      throw CannotWrite(folder, reason);
    }
  } catch (const InputError& reason) {
    throw InputError(folder.string() + ": output folder cannot be written in: " + reason.what());
  }
}

}  // namespace rds
