#include "io/temporary_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace rds {
namespace {

// More than are ever under way at once. A path beyond them is removed by its destructor all the same.
constexpr int kSlots = 64;

// A path belongs to whoever takes it out of its slot, so the signal handler never reads one that is being freed.
std::array<std::atomic<char*>, kSlots> slots{};
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler reads them");

// A free slot, filled with a copy of the path; -1 if there is none.
int Occupy(const std::filesystem::path& path) {
  char* const copy = strdup(path.c_str());
  for (int i = 0; copy != nullptr && i < kSlots; ++i) {
    char* expected = nullptr;
    if (slots[static_cast<std::size_t>(i)].compare_exchange_strong(expected, copy)) {
      return i;
    }
  }
  std::free(copy);
  return -1;
}

}  // namespace

TemporaryPath::TemporaryPath(std::filesystem::path path) : path_(std::move(path)), slot_(Occupy(path_)) {}

TemporaryPath::TemporaryPath(TemporaryPath&& other) noexcept
    : path_(std::exchange(other.path_, {})), slot_(std::exchange(other.slot_, -1)) {}

TemporaryPath::~TemporaryPath() { Remove(); }

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
    std::free(slots[static_cast<std::size_t>(std::exchange(slot_, -1))].exchange(nullptr));
  }
}

void RemoveTemporaryFiles() noexcept {
  for (std::atomic<char*>& slot : slots) {
    if (const char* const path = slot.exchange(nullptr)) {
      unlink(path);
    }
  }
}

}  // namespace rds
