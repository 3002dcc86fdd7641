// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/range_bytes.h"

namespace engram::encoders {

/// A probability of a one: 1 to 65535 of 65536.
using BitProbability = uint32_t;
inline constexpr int kProbabilityBits = 16;

/// Writes bits of known probability into few bytes: one of probability p takes about -log2(p).
/// Integer arithmetic only, so every machine writes and reads the same.
///
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Numbers".
class BinaryEncoder {
 public:
  static constexpr bool kIsDecoder = false;

  /// Returns `bit`, as a decoder returns what it reads: one walk serves both.
  bool code(bool bit, BitProbability one);

  /// `count` bits (1 to 16) whose values are all alike, at once. Returns `value`.
  uint32_t code_even(uint32_t value, int count);

  /// Ends the stream; zero bytes at its end are left out. The encoder must not be used afterwards.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  RangeOutput output_;
};

/// A port that writes nothing: what is left of coding is learning.
class BinaryListener {
 public:
  static constexpr bool kIsDecoder = false;
  bool code(bool bit, BitProbability) { return bit; }
};

/// Reads what BinaryEncoder wrote, given the same probabilities. Any bytes give some bits: whether
/// they are the written ones is for a checksum to say (checked_block.h). Never reads outside.
///
/// Threading: one thread.
class BinaryDecoder {
 public:
  static constexpr bool kIsDecoder = true;

  /// `bytes` outlive the decoder.
  explicit BinaryDecoder(std::span<const std::byte> bytes) : input_(bytes) {}

  /// The next bit; the first argument is not looked at.
  bool code(bool, BitProbability one);
  uint32_t code_even(uint32_t, int count);

 private:
  RangeInput input_;
};

}  // namespace engram::encoders
