// SPDX-License-Identifier: Apache-2.0
// Logging: spdlog to standard error. Usage: log::info("{} keyframes", n). Thread-safe.
#pragma once

#include <spdlog/spdlog.h>

namespace rds::log {

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

// Sends messages to standard error as "rds: warning: ...". Called once by main; a library user keeps spdlog's default.
void SetUp(bool verbose);

}  // namespace rds::log
