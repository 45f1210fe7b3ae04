// SPDX-License-Identifier: Apache-2.0
// Vectors of bytes as wide as the processor's registers. The arithmetic is exact, so results do not depend on the
// width.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
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

// Half as many lanes of 16 bits.
using WordVector = std::uint16_t __attribute__((vector_size(kByteLanes)));
inline constexpr int kWordLanes = kByteLanes / 2;

// Widens bytes from any address; narrows words below 256 to any address.
inline WordVector LoadWidened(const std::uint8_t* from) {
  std::uint8_t __attribute__((vector_size(kWordLanes))) bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return __builtin_convertvector(bytes, WordVector);
}

inline void StoreNarrowed(std::uint8_t* to, WordVector v) {
  using Narrow = std::uint8_t __attribute__((vector_size(kWordLanes)));
  const Narrow bytes = __builtin_convertvector(v, Narrow);
  std::memcpy(to, &bytes, sizeof bytes);
}

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

// Bit i tells whether lane i of a is less than that of b.
inline std::uint64_t LessMask(ByteVector a, ByteVector b) {
#if defined(__AVX512BW__)
  return _mm512_cmplt_epu8_mask(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b));
#elif defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(reinterpret_cast<__m256i>(a < b)));
#elif defined(__SSE2__)
  return static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(a < b)));
#else
  const auto less = a < b;
  std::uint64_t mask = 0;
  for (int i = 0; i < kByteLanes; ++i) {
    mask |= static_cast<std::uint64_t>(less[i] & 1) << i;
  }
  return mask;
#endif
}

// Whether any lane of a is less than that of b.
inline bool AnyLess(ByteVector a, ByteVector b) {
#if defined(__SSE2__)
  return LessMask(a, b) != 0;
#else
  const auto less = a < b;
  std::uint64_t words[sizeof less / sizeof(std::uint64_t)];
  std::memcpy(words, &less, sizeof less);
  std::uint64_t any = 0;
  for (const std::uint64_t word : words) {
    any |= word;
  }
  return any != 0;
#endif
}

}  // namespace rds
