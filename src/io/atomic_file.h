// SPDX-License-Identifier: Apache-2.0
// Output files that are whole or not there.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace rds {

// A file to be written.
struct OutputFile {
  std::filesystem::path path;
  std::string text;
};

// Writes a temporary file beside each target, makes sure that its bytes are on the disk, and only when all are there
// renames them: after an error (disk full, folder not writable) every target is as it was, and no temporary file is
// left. What killed runs left beside them is removed. Nothing is written through links that another user made. Targets
// that are no regular files (/dev/stdout) are written straight. InputError names the path and the system's reason.
void WriteFilesAtomically(std::span<const OutputFile> files);

// The same for one file.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

// Proves that the above could write `path`, and leaves no trace: to be called before the work whose result goes there.
// InputError otherwise.
void CheckWritable(const std::filesystem::path& path);

// Makes the folder (and those above it) if it is not there, and proves with a small file that one can write in it.
// InputError otherwise: to be called before the work whose results go there.
void PrepareOutputFolder(const std::filesystem::path& folder);

}  // namespace rds
