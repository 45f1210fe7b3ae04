// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace rds {
namespace {

// Closes what it holds.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) {
      close(number_);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

InputError CannotRead(const std::filesystem::path& path, const std::string& reason) {
  return InputError(path.string() + ": cannot be read: " + reason);
}

}  // namespace

std::string ReadFile(const std::filesystem::path& path, std::size_t most_bytes) {
  const auto check_size = [&](std::size_t bytes) {
    if (bytes > most_bytes) {
      throw CannotRead(path, "more than " + std::to_string(most_bytes) + " bytes, too large for what it should be");
    }
  };
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // a pipe without a writer: no wait
  struct stat status {};
  if (file.number() < 0 || fstat(file.number(), &status) != 0) {
    throw CannotRead(path, std::strerror(errno));
  }
  if (S_ISDIR(status.st_mode)) {
    throw CannotRead(path, std::strerror(EISDIR));
  }
  if (!S_ISREG(status.st_mode)) {
    throw CannotRead(path, "a pipe or a device; a file is wanted");
  }
  check_size(static_cast<std::size_t>(status.st_size));
  std::string text;
  text.reserve(static_cast<std::size_t>(status.st_size) + 1);
  for (;;) {
    const std::size_t size = text.size();
    text.resize(std::max(size + 4096, text.capacity()));
    const ssize_t count = read(file.number(), text.data() + size, text.size() - size);
    text.resize(size + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    check_size(text.size());  // it may have grown, or not know its size
    if (count == 0) {
      return text;
    }
    if (count < 0 && errno != EINTR) {
      throw CannotRead(path, std::strerror(errno));
    }
  }
}

}  // namespace rds
