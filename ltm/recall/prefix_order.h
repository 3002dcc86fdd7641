// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::ltm {

/// Orders the first entries of a permutation, however many of them: what has arrived until now, by
/// its own times.
///
/// It holds one bit for each entry and binary digit of their number (a wavelet matrix): 3 bytes an
/// entry for ten million.
/// Threading: immutable.
/// Complexity: O(log n) for each question, O(n log n) to build.
/// Source: Claude, Navarro, Ordonez, "The wavelet matrix", Information Systems 47, 2015.
class PrefixOrder {
 public:
  /// Of no entries.
  PrefixOrder() = default;

  /// Needs each number below the size of `permutation` once.
  explicit PrefixOrder(std::span<const uint32_t> permutation);

  /// How many of the first `count` entries are less than `bound`. Needs `count` entries (checked).
  [[nodiscard]] size_t below(size_t count, size_t bound) const;

  /// The entry with this index in the order of the first `count` ones. Needs an index less than
  /// `count`, and so many entries (checked).
  [[nodiscard]] uint32_t nth(size_t count, size_t index) const;

 private:
  /// One binary digit of each entry, in the order in which the digits above it left them: those
  /// with a zero first.
  class Digits {
   public:
    explicit Digits(size_t size);
    void set(size_t place) { words_[place / 64] |= uint64_t{1} << (place % 64); }
    /// Call it once all are set.
    void count();
    /// How many of the first `count` digits are ones.
    [[nodiscard]] size_t ones(size_t count) const;
    [[nodiscard]] size_t zeros() const { return zeros_; }

   private:
    size_t size_ = 0;
    size_t zeros_ = 0;
    std::vector<uint64_t> words_;
    std::vector<uint32_t> ones_before_;  ///< Before each block of words.
  };

  /// Places in a level of digits.
  struct Range {
    size_t begin = 0, end = 0;
  };
  /// Where the entries of a range that have this digit are in the level below.
  static Range part(const Digits& digits, const Range& range, bool digit);

  size_t size_ = 0;
  std::vector<Digits> levels_;  ///< From the highest digit on.
};

}  // namespace engram::ltm
