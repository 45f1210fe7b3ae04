// SPDX-License-Identifier: Apache-2.0
#include "base/random.h"

#include <cmath>
#include <numbers>

namespace rds {

std::uint64_t Random::Bits() {
  std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double Random::Uniform(double low, double high) {
  return low + (high - low) * (static_cast<double>(Bits() >> 11) * 0x1.0p-53);
}

std::uint32_t Random::Index(std::uint32_t bound) { return static_cast<std::uint32_t>(((Bits() >> 32) * bound) >> 32); }

double Random::Gaussian(double mean, double sigma) {
  const double u = 1.0 - Uniform(0.0, 1.0);  // (0, 1], so that the logarithm is finite
  const double v = Uniform(0.0, 1.0);
  return mean + sigma * std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace rds
