// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/copy_past_caches.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>

#include "ltm/core/check.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace engram {

#ifdef __SSE2__

namespace {

constexpr size_t kCacheLine = 64;
constexpr size_t kWide = sizeof(__m128i);

}  // namespace

void copy_past_caches(std::span<const std::byte> from, std::span<std::byte> to) {
  ENGRAM_CHECK(from.size() == to.size(), "{} bytes to {}", from.size(), to.size());
  if (from.empty()) return;
  // Whole lines are gathered on their way to memory, parts of lines are not.
  const size_t misaligned = reinterpret_cast<uintptr_t>(to.data()) % kCacheLine;
  const size_t before = std::min(misaligned == 0 ? 0 : kCacheLine - misaligned, from.size());
  std::memcpy(to.data(), from.data(), before);
  size_t at = before;
  for (; at + kCacheLine <= from.size(); at += kCacheLine) {
    const auto* source = reinterpret_cast<const __m128i*>(from.data() + at);
    auto* target = reinterpret_cast<__m128i*>(to.data() + at);
    __m128i line[kCacheLine / kWide];
    for (size_t i = 0; i < std::size(line); ++i) line[i] = _mm_loadu_si128(source + i);
    for (size_t i = 0; i < std::size(line); ++i) _mm_stream_si128(target + i, line[i]);
  }
  std::memcpy(to.data() + at, from.data() + at, from.size() - at);
  // Such stores are not ordered with others by themselves.
  _mm_sfence();
}

#else

void copy_past_caches(std::span<const std::byte> from, std::span<std::byte> to) {
  ENGRAM_CHECK(from.size() == to.size(), "{} bytes to {}", from.size(), to.size());
  if (!from.empty()) std::memcpy(to.data(), from.data(), from.size());
}

#endif

}  // namespace engram
