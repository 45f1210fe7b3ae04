#include "io/temporary_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <string>
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
    SlotState expected = SlotState::kUnderWay;  // a removed one stays so: the program is ending
    slots[static_cast<std::size_t>(std::exchange(slot_, -1))].state.compare_exchange_strong(expected, SlotState::kFree);
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
