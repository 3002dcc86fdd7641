// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/prefix_order.h"

#include <algorithm>
#include <bit>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

constexpr size_t kWordsInBlock = 8;

}  // namespace

PrefixOrder::Digits::Digits(size_t size) : size_(size), words_(size / 64 + 1) {}

void PrefixOrder::Digits::count() {
  uint32_t ones = 0;
  for (size_t i = 0; i < words_.size(); ++i) {
    if (i % kWordsInBlock == 0) ones_before_.push_back(ones);
    ones += static_cast<uint32_t>(std::popcount(words_[i]));
  }
  zeros_ = size_ - ones;
}

size_t PrefixOrder::Digits::ones(size_t count) const {
  const size_t word = count / 64;
  const size_t block = word / kWordsInBlock;
  size_t ones = ones_before_[block];
  for (size_t i = block * kWordsInBlock; i < word; ++i)
    ones += static_cast<size_t>(std::popcount(words_[i]));
  const uint64_t before = (uint64_t{1} << (count % 64)) - 1;
  return ones + static_cast<size_t>(std::popcount(words_[word] & before));
}

PrefixOrder::PrefixOrder(std::span<const uint32_t> permutation) : size_(permutation.size()) {
  std::vector<uint32_t> entries(permutation.begin(), permutation.end());
  std::vector<uint32_t> sorted(size_);
  for (int digit = std::bit_width(size_) - 1; digit >= 0; --digit) {
    Digits& level = levels_.emplace_back(size_);
    const auto is_one = [digit](uint32_t entry) { return ((entry >> digit) & 1) != 0; };
    for (size_t i = 0; i < size_; ++i)
      if (is_one(entries[i])) level.set(i);
    level.count();
    size_t zero = 0, one = level.zeros();
    for (const uint32_t entry : entries) sorted[is_one(entry) ? one++ : zero++] = entry;
    entries.swap(sorted);
  }
}

PrefixOrder::Range PrefixOrder::part(const Digits& digits, const Range& range, bool digit) {
  const size_t begin = digits.ones(range.begin), end = digits.ones(range.end);
  if (digit) return {digits.zeros() + begin, digits.zeros() + end};
  return {range.begin - begin, range.end - end};
}

size_t PrefixOrder::below(size_t count, size_t bound) const {
  ENGRAM_CHECK(count <= size_, "found {} of {} entries", count, size_);
  if (bound >= size_) return count;
  size_t found = 0;
  Range range{0, count};
  for (size_t level = 0; level < levels_.size() && range.begin < range.end; ++level) {
    const bool digit = ((bound >> (levels_.size() - 1 - level)) & 1) != 0;
    const Range part = this->part(levels_[level], range, digit);
    // Those with a zero where the bound has a one are less.
    if (digit) found += (range.end - range.begin) - (part.end - part.begin);
    range = part;
  }
  return found;
}

uint32_t PrefixOrder::nth(size_t count, size_t index) const {
  ENGRAM_CHECK(count <= size_ && index < count, "found entry {} of {} of {}", index, count, size_);
  uint32_t entry = 0;
  Range range{0, count};
  for (const Digits& digits : levels_) {
    const Range zeros = part(digits, range, false);
    const size_t number = zeros.end - zeros.begin;
    const bool digit = index >= number;
    if (digit) index -= number;
    range = digit ? part(digits, range, true) : zeros;
    entry = entry * 2 + (digit ? 1 : 0);
  }
  return entry;
}

}  // namespace engram::ltm
