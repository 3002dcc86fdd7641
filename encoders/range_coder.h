// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/range_bytes.h"
#include "ltm/core/status.h"

namespace engram::encoders {

/// Integer frequencies of one distribution over the integers [first, first + n) and an escape,
/// behind which any other 32-bit integer follows in plain bits.
///
/// Threading: immutable.
class FrequencyTable {
 public:
  static constexpr int kBits = 15;  ///< The frequencies add up to 2^kBits.
  static constexpr size_t kMaxSymbols = 1 << 12;

  /// A table of -1, 0 and 1.
  FrequencyTable();

  /// Fits the counts of [first, first + counts.size()), smoothed by a Laplace distribution of the
  /// same mean and spread. Keeps kMaxSymbols counts at most: those around the mean.
  static FrequencyTable from_counts(int32_t first, std::span<const uint64_t> counts);

  /// Takes stored frequencies, that of the escape last.
  /// Errors: kDataLoss where one is zero or they do not add up.
  static Result<FrequencyTable> from_frequencies(int32_t first,
                                                 std::span<const uint16_t> frequencies);

  [[nodiscard]] int32_t first() const { return first_; }
  [[nodiscard]] std::vector<uint16_t> frequencies() const;

  /// Number of symbols, the escape included; it is the last.
  [[nodiscard]] size_t symbols() const { return cumulative_.size() - 1; }
  [[nodiscard]] size_t escape() const { return symbols() - 1; }

  /// Sum of the frequencies before `symbol`; `symbol` may be symbols().
  [[nodiscard]] uint32_t start(size_t symbol) const { return cumulative_[symbol]; }

  /// The symbol whose interval holds `position` (below 2^kBits).
  [[nodiscard]] size_t find(uint32_t position) const;

 private:
  FrequencyTable(int32_t first, std::vector<uint32_t> cumulative)
      : first_(first), cumulative_(std::move(cumulative)) {}

  int32_t first_;
  std::vector<uint32_t> cumulative_;
};

/// Writes integers under frequency tables into few bytes. Integer arithmetic only: every machine
/// writes and reads the same.
///
/// Threading: one thread.
/// Source: docs/learning.md, section "The code of a latent".
class RangeEncoder {
 public:
  void put(const FrequencyTable& table, int32_t value);

  /// Ends the stream. The encoder must not be used afterwards.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  void narrow(uint32_t start, uint32_t size, int bits);
  void put_plain(uint32_t value);

  RangeOutput output_;
};

/// Reads what RangeEncoder wrote, given the same tables. Any bytes give some integers: whether
/// they are the written ones is for a checksum to say.
///
/// Threading: one thread.
class RangeDecoder {
 public:
  /// `bytes` outlive the decoder.
  explicit RangeDecoder(std::span<const std::byte> bytes) : input_(bytes) {}

  [[nodiscard]] int32_t get(const FrequencyTable& table);

 private:
  [[nodiscard]] uint32_t position(int bits);
  void narrow(uint32_t start, uint32_t size);
  [[nodiscard]] uint32_t get_plain();

  RangeInput input_;
  uint32_t unit_ = 1;
};

}  // namespace engram::encoders
