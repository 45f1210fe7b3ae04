// SPDX-License-Identifier: Apache-2.0
#include "cli/processor_needs.h"

namespace rds {

// The compiler defines a name for each set of instructions that it may use.
constinit const ProcessorNeeds kProcessorNeeds = {
#ifdef __SSE4_2__
    .sse42 = true,
#endif
#ifdef __AVX__
    .avx = true,
#endif
#ifdef __AVX2__
    .avx2 = true,
#endif
#ifdef __FMA__
    .fma = true,
#endif
#ifdef __BMI__
    .bmi = true,
#endif
#ifdef __BMI2__
    .bmi2 = true,
#endif
#ifdef __FMA4__
    .fma4 = true,
#endif
#ifdef __XOP__
    .xop = true,
#endif
#ifdef __AVX512F__
    .avx512f = true,
#endif
#ifdef __AVX512VL__
    .avx512vl = true,
#endif
#ifdef __AVX512BW__
    .avx512bw = true,
#endif
#ifdef __AVX512DQ__
    .avx512dq = true,
#endif
};

}  // namespace rds
