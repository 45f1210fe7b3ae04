// Vectors of bytes as wide as the processor's registers. The arithmetic is exact, so results do not depend on the
// width.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__AVX2__) || defined(__SSE2__)
#include <immintrin.h>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#endif

namespace rds {

#if defined(__AVX512BW__)
inline constexpr int kByteLanes = 64;
#elif defined(__AVX2__)
inline constexpr int kByteLanes = 32;
#else
inline constexpr int kByteLanes = 16;
#endif

using ByteVector = std::uint8_t __attribute__((vector_size(kByteLanes)));

// Bytes from or to any address.
inline ByteVector LoadBytes(const std::uint8_t* from) {
  ByteVector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

inline void StoreBytes(std::uint8_t* to, ByteVector v) { std::memcpy(to, &v, sizeof v); }

inline ByteVector Min(ByteVector a, ByteVector b) { return a < b ? a : b; }
inline ByteVector Max(ByteVector a, ByteVector b) { return a > b ? a : b; }

// max(a - b, 0)
inline ByteVector SubtractSaturated(ByteVector a, ByteVector b) { return Max(a, b) - b; }

// (a + b + 1) / 2
inline ByteVector Average(ByteVector a, ByteVector b) {
#if defined(__AVX512BW__)
  return reinterpret_cast<ByteVector>(_mm512_avg_epu8(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
#elif defined(__AVX2__)
  return reinterpret_cast<ByteVector>(_mm256_avg_epu8(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__)
  return reinterpret_cast<ByteVector>(_mm_avg_epu8(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return (a | b) - ((a ^ b) >> 1);
#endif
}

inline bool AnyNonZero(ByteVector v) {
#if defined(__AVX512BW__)
  return _mm512_test_epi8_mask(reinterpret_cast<__m512i>(v), reinterpret_cast<__m512i>(v)) != 0;
#elif defined(__AVX2__)
  return _mm256_testz_si256(reinterpret_cast<__m256i>(v), reinterpret_cast<__m256i>(v)) == 0;
#else
  std::uint64_t words[sizeof v / sizeof(std::uint64_t)];
  std::memcpy(words, &v, sizeof v);
  std::uint64_t any = 0;
  for (const std::uint64_t word : words) {
    any |= word;
  }
  return any != 0;
#endif
}

}  // namespace rds
