// SPDX-License-Identifier: Apache-2.0
// The program's version.
#pragma once

namespace rds {

// The same as in CMakeLists.txt (a test checks it); the changes of each version are in CHANGELOG.md.
inline constexpr const char* kVersion = "0.1.0";

}  // namespace rds
