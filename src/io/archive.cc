// SPDX-License-Identifier: Apache-2.0
#include "io/archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <string>
#include <system_error>

#include "base/error.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr int kMostEntries = 1'000'000;
constexpr std::size_t kBlock_bytes = 1U << 16U;

[[noreturn]] void Refuse(const fs::path& file, const std::string& what) {
  throw ArchiveError(fmt::format("{}: {}; it is not unpacked further", file.string(), what));
}

// Its path within the archive, which leads nowhere else.
fs::path SafePath(const fs::path& file, archive_entry* entry) {
  const char* const name = archive_entry_pathname(entry);
  if (name == nullptr || *name == '\0') {
    Refuse(file, "an entry has no name");
  }
  const fs::path path = fs::path(name).lexically_normal();
  if (path.is_absolute() || std::ranges::any_of(path, [](const fs::path& part) { return part == ".."; })) {
    Refuse(file, fmt::format("entry '{}' leads out of the folder", name));
  }
  if (archive_entry_hardlink(entry) != nullptr ||
      (archive_entry_filetype(entry) != AE_IFREG && archive_entry_filetype(entry) != AE_IFDIR)) {
    Refuse(file, fmt::format("entry '{}' is neither a file nor a folder", name));
  }
  return path;
}

void CheckStep(const fs::path& file, archive* from, la_ssize_t code) {
  if (code < ARCHIVE_WARN) {
    const char* const reason = archive_error_string(from);
    Refuse(file, fmt::format("damaged or cut short ({})", reason == nullptr ? "unknown" : reason));
  }
}

void CheckWritten(const fs::path& folder, archive* to, la_ssize_t code) {
  if (code < ARCHIVE_WARN) {
    const char* const reason = archive_error_string(to);
    throw InputError(fmt::format("{}: cannot be written ({}); is the disk full?", folder.string(),
                                 reason == nullptr ? "unknown" : reason));
  }
}

}  // namespace

void Unpack(const fs::path& file, const fs::path& folder, std::int64_t most_bytes,
            const std::function<void(std::int64_t)>& progress) {
  const std::unique_ptr<archive, decltype(&archive_read_free)> reader(archive_read_new(), &archive_read_free);
  const std::unique_ptr<archive, decltype(&archive_write_free)> writer(archive_write_disk_new(), &archive_write_free);
  Check(reader != nullptr && writer != nullptr, "libarchive has no memory");
  archive_read_support_filter_all(reader.get());
  archive_read_support_format_all(reader.get());
  archive_write_disk_set_options(writer.get(), ARCHIVE_EXTRACT_SECURE_SYMLINKS | ARCHIVE_EXTRACT_SECURE_NODOTDOT);
  CheckStep(file, reader.get(), archive_read_open_filename(reader.get(), file.c_str(), kBlock_bytes));
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  std::int64_t written = 0;
  archive_entry* entry = nullptr;
  for (int entries = 0;; ++entries) {
    const int next = archive_read_next_header(reader.get(), &entry);
    if (next == ARCHIVE_EOF) {
      break;
    }
    CheckStep(file, reader.get(), next);
    if (entries >= kMostEntries) {
      Refuse(file, "more entries than a sequence has");
    }
    archive_entry_set_pathname(entry, (folder / SafePath(file, entry)).c_str());
    archive_entry_set_perm(entry, archive_entry_filetype(entry) == AE_IFDIR ? 0755 : 0644);
    CheckWritten(folder, writer.get(), archive_write_header(writer.get(), entry));
    const void* block = nullptr;
    std::size_t size = 0;
    la_int64_t offset = 0;
    for (;;) {
      const int read = archive_read_data_block(reader.get(), &block, &size, &offset);
      if (read == ARCHIVE_EOF) {
        break;
      }
      CheckStep(file, reader.get(), read);
      written += static_cast<std::int64_t>(size);
      if (written > most_bytes || offset > most_bytes) {
        Refuse(file, "larger than any sequence");
      }
      CheckWritten(folder, writer.get(), archive_write_data_block(writer.get(), block, size, offset));
      if (progress) {
        progress(archive_filter_bytes(reader.get(), -1));
      }
    }
    CheckWritten(folder, writer.get(), archive_write_finish_entry(writer.get()));
  }
}

}  // namespace rds
