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

/// A range coder: a bit of probability p takes about -log2(p) bits. It uses integer arithmetic
/// only, so every machine writes and reads the same bytes.
///
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Numbers".
class BinaryEncoder {
 public:
  static constexpr bool kIsDecoder = false;

  /// Returns `bit`, as the decoder returns the bit that it reads, so that one function can encode
  /// and decode.
  bool code(bool bit, BitProbability one);

  /// Writes `count` bits (1 to 16) of equally likely values at once. Returns `value`.
  uint32_t code_even(uint32_t value, int count);

  /// Ends the stream, without the zero bytes at its end. The encoder must not be used afterwards.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  RangeOutput output_;
};

/// A port that writes nothing. Coding with it only trains the models.
class BinaryListener {
 public:
  static constexpr bool kIsDecoder = false;
  bool code(bool bit, BitProbability) { return bit; }
};

/// Reads the output of BinaryEncoder, given the same probabilities. Any bytes decode to some bits,
/// so a checksum must tell damage (checked_block.h). It never reads out of bounds.
///
/// Threading: one thread.
class BinaryDecoder {
 public:
  static constexpr bool kIsDecoder = true;

  /// `bytes` must outlive the decoder.
  explicit BinaryDecoder(std::span<const std::byte> bytes) : input_(bytes) {}

  /// Returns the next bit. The first argument is ignored.
  bool code(bool, BitProbability one);
  uint32_t code_even(uint32_t, int count);

 private:
  RangeInput input_;
};

}  // namespace engram::encoders
