// Images from files.
#pragma once

#include <filesystem>

#include "base/image.h"

namespace rds {

// All of them take PNG and, where eight bits are enough, JPEG; check that the file is whole before they decode it;
// throw InputError naming the file, what is wrong and what to do; keep no state: any thread may call them.

// BGR, three channels (a grey picture gives three equal ones). An orientation tag is ignored.
Image8 ReadColor(const std::filesystem::path& path);

// Depth as stored: one channel of 16 bits; an 8-bit picture is an error, not stretched.
Image16 ReadDepth(const std::filesystem::path& path);

// A mask, one channel: 255 where the file is not 0 (any channel), else 0.
Image8 ReadMask(const std::filesystem::path& path);

}  // namespace rds
