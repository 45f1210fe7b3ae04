// SPDX-License-Identifier: Apache-2.0
// Instructions that this build uses and older processors of its kind lack.
#pragma once

namespace rds {

struct ProcessorNeeds {
  bool sse42 = false;
  bool avx = false;
  bool avx2 = false;
  bool fma = false;
  bool bmi = false;
  bool bmi2 = false;
  bool fma4 = false;
  bool xop = false;
  bool avx512f = false;
  bool avx512vl = false;
  bool avx512bw = false;
  bool avx512dq = false;
};

// Compiled with the flags of everything else; a constant, so reading it runs no such instruction.
extern const ProcessorNeeds kProcessorNeeds;

}  // namespace rds
