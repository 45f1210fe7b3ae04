// SPDX-License-Identifier: Apache-2.0
// Seeded random numbers that are the same on every platform (the standard's distributions are not).
#pragma once

#include <cstdint>

namespace rds {

// SplitMix64 generator; not thread-safe, one instance per use.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // Uniform over all 64-bit values.
  std::uint64_t Bits();
  // Uniform in [low, high).
  double Uniform(double low, double high);
  // Uniform in {0, ..., bound - 1}; bound > 0.
  std::uint32_t Index(std::uint32_t bound);
  // Normal with the given mean and standard deviation (Box-Muller).
  double Gaussian(double mean, double sigma);

 private:
  std::uint64_t state_;
};

}  // namespace rds
