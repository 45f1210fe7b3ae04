// SPDX-License-Identifier: Apache-2.0
// What the system knows about this process.
#pragma once

namespace rds {

// Wall time since the process was started (exec), in seconds; steps of a clock tick, 10 ms.
[[nodiscard]] double SecondsSinceProcessStart();

// Largest resident memory so far, in MB (10^6 bytes).
[[nodiscard]] double PeakMemoryMb();

}  // namespace rds
