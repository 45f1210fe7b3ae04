// SPDX-License-Identifier: Apache-2.0
// Unpacking archives that others made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "base/error.h"

namespace rds {

// The archive is to blame, not the disk.
class ArchiveError : public InputError {
  using InputError::InputError;
};

// Unpacks a .tgz, .zip or any other archive that libarchive reads into `folder`, which is made. Folders and regular
// files only, and none outside `folder`: an absolute name, one with "..", a link or a device is an ArchiveError, as is
// an archive that is damaged, holds more than a million entries, or more than `most_bytes`; a disk that cannot be
// written is another InputError. What was unpacked until then stays. `progress`: bytes of the archive that are done; it
// may throw, which ends the work.
void Unpack(const std::filesystem::path& archive, const std::filesystem::path& folder, std::int64_t most_bytes,
            const std::function<void(std::int64_t done)>& progress);

}  // namespace rds
