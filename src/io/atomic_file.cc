#include "io/atomic_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/temporary_files.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

InputError WriteError(const fs::path& path, int error) {
  std::string message = path.string() + ": cannot be written: " + std::strerror(error);
  if (error == ENOSPC || error == EDQUOT) {
    message += "; make room or choose another place";
  }
  return InputError(message);
}

// Writes and closes; the number of the system's error, or 0.
int WriteAll(int file, std::string_view text, bool sync) {
  int error = 0;
  while (!text.empty() && error == 0) {
    const ssize_t count = write(file, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (error == 0 && sync && fsync(file) != 0) {
    error = errno;
  }
  if (close(file) != 0 && error == 0) {
    error = errno;
  }
  return error;
}

// A file beside its target that disappears unless renamed. Not thread-safe.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : target_(target), temporary_(NameBeside(target)) {}

  // Both give the number of the system's error, or 0.
  [[nodiscard]] int Write(std::string_view text) {
    const int file = open(temporary_.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) {
      return WriteAll(file, text, true);
    }
    const int error = errno;
    temporary_.Disown();
    return error;
  }
  [[nodiscard]] int Rename() { return temporary_.MoveTo(target_); }

  [[nodiscard]] const fs::path& target() const { return target_; }

 private:
  static fs::path NameBeside(const fs::path& target) {
    static std::atomic<unsigned> counter = 0;
    return target.parent_path() / fmt::format(".{}.{}-{}", target.filename().string(), getpid(), counter++);
  }

  fs::path target_;
  TemporaryPath temporary_;
};

// For /dev/stdout and the like, which must not be replaced by a file.
void WriteStraight(const fs::path& path, std::string_view text) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  const int error = file < 0 ? errno : WriteAll(file, text, false);
  if (error != 0) {
    throw WriteError(path, error);
  }
}

// The regular file to replace: what a link points to, so that a link stays a link. Nothing for a device.
std::optional<fs::path> FileToReplace(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    throw WriteError(path, EISDIR);
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return std::nullopt;
  }
  return fs::is_symlink(fs::symlink_status(path, ignored)) ? fs::weakly_canonical(path) : path;
}

}  // namespace

void WriteFilesAtomically(std::span<const OutputFile> files) {
  std::vector<TemporaryFile> temporary;
  std::vector<const OutputFile*> straight;
  for (const OutputFile& file : files) {
    const std::optional<fs::path> target = FileToReplace(file.path);
    if (!target) {
      straight.push_back(&file);
      continue;
    }
    if (const int error = temporary.emplace_back(*target).Write(file.text); error != 0) {
      throw WriteError(file.path, error);
    }
  }
  for (const OutputFile* file : straight) {
    WriteStraight(file->path, file->text);
  }
  for (TemporaryFile& file : temporary) {
    if (const int error = file.Rename(); error != 0) {
      throw WriteError(file.target(), error);
    }
  }
}

void WriteFileAtomically(const fs::path& path, std::string_view text) {
  const OutputFile file{path, std::string(text)};
  WriteFilesAtomically({&file, 1});
}

void CheckWritable(const fs::path& path) {
  const std::optional<fs::path> target = FileToReplace(path);
  if (const int error = target ? TemporaryFile(*target).Write("\n") : 0; error != 0) {
    throw WriteError(path, error);
  }
}

void PrepareOutputFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw InputError(
        fmt::format("{}: output folder cannot be made: {}", folder.string(), error ? error.message() : "not a folder"));
  }
  if (const int reason = TemporaryFile(folder / "probe").Write(std::string(4096, '\n')); reason != 0) {
    throw InputError(folder.string() + ": output folder cannot be written in: " + std::strerror(reason));
  }
}

}  // namespace rds
