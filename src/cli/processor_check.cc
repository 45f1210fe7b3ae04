// SPDX-License-Identifier: Apache-2.0
// A processor that lacks instructions of this build gets a sentence instead of a signal. Compiled for the oldest
// processor (see CMakeLists.txt), and run before any other constructor of the program.
#include <unistd.h>

#include <cstring>

#include "cli/processor_needs.h"

#if defined(__x86_64__) && defined(__GNUC__)

namespace {

// The first of them that is missing; null if none is.
const char* Missing(const rds::ProcessorNeeds& needs) {
  __builtin_cpu_init();
  return needs.sse42 && !__builtin_cpu_supports("sse4.2")        ? "SSE4.2"
         : needs.avx && !__builtin_cpu_supports("avx")           ? "AVX"
         : needs.avx2 && !__builtin_cpu_supports("avx2")         ? "AVX2"
         : needs.fma && !__builtin_cpu_supports("fma")           ? "FMA"
         : needs.bmi && !__builtin_cpu_supports("bmi")           ? "BMI"
         : needs.bmi2 && !__builtin_cpu_supports("bmi2")         ? "BMI2"
         : needs.fma4 && !__builtin_cpu_supports("fma4")         ? "FMA4"
         : needs.xop && !__builtin_cpu_supports("xop")           ? "XOP"
         : needs.avx512f && !__builtin_cpu_supports("avx512f")   ? "AVX-512"
         : needs.avx512vl && !__builtin_cpu_supports("avx512vl") ? "AVX-512VL"
         : needs.avx512bw && !__builtin_cpu_supports("avx512bw") ? "AVX-512BW"
         : needs.avx512dq && !__builtin_cpu_supports("avx512dq") ? "AVX-512DQ"
                                                                 : nullptr;
}

void Say(const char* text) { static_cast<void>(!write(STDERR_FILENO, text, std::strlen(text))); }

// 101 is the first priority that programs may use.
__attribute__((constructor(101))) void CheckProcessor() {
  if (const char* const missing = Missing(rds::kProcessorNeeds)) {
    Say("rds: error: this program was built for a processor with ");
    Say(missing);
    Say(", which this one lacks; build it here, or for all processors with -DRDS_NATIVE=OFF\n");
    _exit(1);
  }
}

}  // namespace

#endif
