// SPDX-License-Identifier: Apache-2.0
#include "io/temporary_files.h"

#include <fcntl.h>
#include <signal.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace rds {
namespace {

// More than are ever under way at once. A path beyond them is removed by its destructor all the same.
constexpr int kSlots = 64;

enum class SlotState { kFree, kTaken, kUnderWay, kRemoved };

// Nothing in it is ever freed, so the signal handler may read it at any moment.
struct Slot {
  std::atomic<SlotState> state = SlotState::kFree;
  std::array<char, PATH_MAX> path{};
};
std::array<Slot, kSlots> slots;
static_assert(std::atomic<SlotState>::is_always_lock_free, "a signal handler reads them");

// A free slot, filled with a copy of the path; -1 if there is none.
int Occupy(const std::filesystem::path& path) {
  const std::string& text = path.native();
  for (int i = 0; text.size() < PATH_MAX && i < kSlots; ++i) {
    Slot& slot = slots[static_cast<std::size_t>(i)];
    SlotState expected = SlotState::kFree;
    if (slot.state.compare_exchange_strong(expected, SlotState::kTaken)) {
      std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
      slot.state = SlotState::kUnderWay;
      return i;
    }
  }
  return -1;
}

constexpr std::string_view kPrefix = ".rds-";
constexpr std::string_view kSuffix = ".tmp";

// ".rds-PID-RANDOM.tmp.mp4"
std::filesystem::path NameBeside(const std::filesystem::path& target) {
  std::random_device random;
  const std::uint64_t high = random();
  const std::string name = fmt::format("{}{}-{:016x}{}{}", kPrefix, getpid(), (high << 32U) | random(), kSuffix,
                                       target.extension().string());
  return target.parent_path() / name;
}

// The process in a name of that form; nothing for other names.
std::optional<pid_t> OwnerIn(const std::string& name) {
  const std::size_t dash = name.find('-', kPrefix.size());
  if (!name.starts_with(kPrefix) || dash == std::string::npos || name.find(kSuffix, dash) == std::string::npos) {
    return std::nullopt;
  }
  pid_t owner = 0;
  const auto [stop, error] = std::from_chars(name.data() + kPrefix.size(), name.data() + dash, owner);
  return error == std::errc{} && stop == name.data() + dash && owner > 0 ? std::optional(owner) : std::nullopt;
}

}  // namespace

TemporaryPath::TemporaryPath(const std::filesystem::path& target) : path_(NameBeside(target)) {
  slot_ = Occupy(path_);
  file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file_ < 0) {
    const int error = errno;
    Disown();
    throw CannotWrite(target, error);
  }
  flock(file_, LOCK_EX | LOCK_NB);
}

TemporaryPath::TemporaryPath(TemporaryPath&& other) noexcept
    : path_(std::exchange(other.path_, {})),
      file_(std::exchange(other.file_, -1)),
      slot_(std::exchange(other.slot_, -1)) {}

TemporaryPath::~TemporaryPath() {
  Remove();
  if (file_ >= 0) {
    close(file_);
  }
}

int TemporaryPath::MoveTo(const std::filesystem::path& target) {
  if (std::rename(path_.c_str(), target.c_str()) != 0) {
    return errno;
  }
  Disown();
  return 0;
}

void TemporaryPath::Remove() {
  if (!path_.empty()) {
    unlink(path_.c_str());
    Disown();
  }
}

void TemporaryPath::Disown() {
  path_.clear();
  if (slot_ >= 0) {
    SlotState expected = SlotState::kUnderWay;  // a removed one stays so: the program is ending
    slots[static_cast<std::size_t>(std::exchange(slot_, -1))].state.compare_exchange_strong(expected, SlotState::kFree);
  }
}

InputError CannotWrite(const std::filesystem::path& path, int error) {
  std::string message = path.string() + ": cannot be written: " + std::strerror(error);
  if (error == ENOSPC || error == EDQUOT) {
    message += "; make room or choose another place";
  }
  return InputError(message);
}

void RemoveAbandonedFiles(const std::filesystem::path& folder) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::optional<pid_t> owner = OwnerIn(entry->path().filename().string());
    if (!owner || kill(*owner, 0) == 0 || errno != ESRCH) {
      continue;
    }
    // The number may be that of another machine's process on a shared disk: the lock tells as well.
    const int file = open(entry->path().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (file >= 0) {
      if (flock(file, LOCK_EX | LOCK_NB) == 0) {
        unlink(entry->path().c_str());
      }
      close(file);
    }
  }
}

void RemoveTemporaryFiles() noexcept {
  for (Slot& slot : slots) {
    SlotState expected = SlotState::kUnderWay;
    if (slot.state.compare_exchange_strong(expected, SlotState::kRemoved)) {
      unlink(slot.path.data());
    }
  }
}

}  // namespace rds
