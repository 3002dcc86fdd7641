// SPDX-License-Identifier: Apache-2.0
#include "encoders/range_coder.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace engram::encoders {

namespace {

constexpr uint32_t kTotal = 1u << FrequencyTable::kBits;
constexpr int kPlainBits = 16;
/// Weight of the smoothing distribution, in observations.
constexpr double kSmoothing = 4.0;
/// Share of the escape, in observations.
constexpr double kEscapeWeight = 0.5;

uint32_t zigzag(int32_t value) {
  return (static_cast<uint32_t>(value) << 1) ^ static_cast<uint32_t>(value >> 31);
}

int32_t unzigzag(uint32_t code) {
  return static_cast<int32_t>((code >> 1) ^ (0u - (code & 1u)));
}

struct Moments {
  double total = 0, mean = 0, spread = 0;
};

Moments moments_of(std::span<const uint64_t> counts) {
  Moments moments;
  for (size_t i = 0; i < counts.size(); ++i) {
    moments.total += static_cast<double>(counts[i]);
    moments.mean += static_cast<double>(counts[i]) * static_cast<double>(i);
  }
  if (moments.total == 0) return moments;
  moments.mean /= moments.total;
  for (size_t i = 0; i < counts.size(); ++i)
    moments.spread += static_cast<double>(counts[i]) *
                      std::abs(static_cast<double>(i) - moments.mean) / moments.total;
  return moments;
}

/// Frequencies of at least one each that add up to kTotal, near-proportional to `weights`.
std::vector<uint32_t> cumulative_of(const std::vector<double>& weights) {
  double sum = 0;
  for (const double weight : weights) sum += weight;
  const double scale = (kTotal - static_cast<double>(weights.size())) / sum;
  std::vector<uint32_t> cumulative{0};
  double exact = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    exact += weights[i] * scale + 1.0;
    const auto end = static_cast<uint32_t>(std::llround(exact));
    cumulative.push_back(std::clamp(end, cumulative.back() + 1,
                                    kTotal - static_cast<uint32_t>(weights.size() - 1 - i)));
  }
  cumulative.back() = kTotal;
  return cumulative;
}

}  // namespace

FrequencyTable::FrequencyTable()
    : FrequencyTable(-1, cumulative_of({1.0, 2.0, 1.0, kEscapeWeight})) {}

FrequencyTable FrequencyTable::from_counts(int32_t first, std::span<const uint64_t> counts) {
  Moments moments = moments_of(counts);
  if (moments.total == 0) return {};
  if (counts.size() > kMaxSymbols) {
    const auto middle = static_cast<size_t>(moments.mean);
    const size_t skip =
        std::min(counts.size() - kMaxSymbols, middle - std::min(middle, kMaxSymbols / 2));
    first += static_cast<int32_t>(skip);
    moments.mean -= static_cast<double>(skip);
    counts = counts.subspan(skip, kMaxSymbols);
  }
  const double spread = std::max(moments.spread, 0.3);
  std::vector<double> weights;
  weights.reserve(counts.size() + 1);
  for (size_t i = 0; i < counts.size(); ++i) {
    const double distance = std::abs(static_cast<double>(i) - moments.mean);
    weights.push_back(static_cast<double>(counts[i]) +
                      kSmoothing * std::exp(-distance / spread) / (2 * spread));
  }
  weights.push_back(kEscapeWeight);
  return FrequencyTable(first, cumulative_of(weights));
}

Result<FrequencyTable> FrequencyTable::from_frequencies(int32_t first,
                                                        std::span<const uint16_t> frequencies) {
  if (frequencies.size() < 2 || frequencies.size() > kMaxSymbols + 1)
    return data_loss("frequency table: found {} symbols, needs 2 to {}", frequencies.size(),
                     kMaxSymbols + 1);
  std::vector<uint32_t> cumulative{0};
  for (const uint16_t frequency : frequencies) {
    if (frequency == 0) return data_loss("frequency table: found a frequency of zero");
    cumulative.push_back(cumulative.back() + frequency);
  }
  if (cumulative.back() != kTotal)
    return data_loss("frequency table: found a sum of {}, needs {}", cumulative.back(), kTotal);
  if (first > INT32_MAX - static_cast<int32_t>(kMaxSymbols))
    return data_loss("frequency table: found a first symbol of {}", first);
  return FrequencyTable(first, std::move(cumulative));
}

std::vector<uint16_t> FrequencyTable::frequencies() const {
  std::vector<uint16_t> result;
  for (size_t i = 0; i < symbols(); ++i)
    result.push_back(static_cast<uint16_t>(cumulative_[i + 1] - cumulative_[i]));
  return result;
}

size_t FrequencyTable::find(uint32_t position) const {
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), position);
  return static_cast<size_t>(above - cumulative_.begin()) - 1;
}

void RangeEncoder::put(const FrequencyTable& table, int32_t value) {
  const int64_t offset = static_cast<int64_t>(value) - table.first();
  const bool is_known = offset >= 0 && offset < static_cast<int64_t>(table.escape());
  const size_t symbol = is_known ? static_cast<size_t>(offset) : table.escape();
  narrow(table.start(symbol), table.start(symbol + 1) - table.start(symbol), FrequencyTable::kBits);
  if (!is_known) put_plain(zigzag(value));
}

// The number of significant bits, then the bits.
void RangeEncoder::put_plain(uint32_t value) {
  const int width = std::bit_width(value);
  narrow(static_cast<uint32_t>(width), 1, 6);
  if (width > kPlainBits) narrow(value >> kPlainBits, 1, width - kPlainBits);
  narrow(value & ((1u << std::min(width, kPlainBits)) - 1), 1, std::min(width, kPlainBits));
}

void RangeEncoder::narrow(uint32_t start, uint32_t size, int bits) {
  const uint32_t unit = output_.range() >> bits;
  output_.narrow(unit * start, unit * size);
}

std::vector<std::byte> RangeEncoder::finish() {
  return output_.finish();
}

uint32_t RangeDecoder::position(int bits) {
  unit_ = input_.range() >> bits;
  return std::min(input_.offset() / unit_, (1u << bits) - 1);
}

void RangeDecoder::narrow(uint32_t start, uint32_t size) {
  input_.narrow(unit_ * start, unit_ * size);
}

uint32_t RangeDecoder::get_plain() {
  const uint32_t found = position(6);
  narrow(found, 1);
  const int width = std::min(static_cast<int>(found), 32);
  uint32_t value = 0;
  if (width > kPlainBits) {
    value = position(width - kPlainBits);
    narrow(value, 1);
    value <<= kPlainBits;
  }
  const uint32_t low = position(std::min(width, kPlainBits));
  narrow(low, 1);
  return value | low;
}

int32_t RangeDecoder::get(const FrequencyTable& table) {
  const size_t symbol = table.find(position(FrequencyTable::kBits));
  narrow(table.start(symbol), table.start(symbol + 1) - table.start(symbol));
  if (symbol == table.escape()) return unzigzag(get_plain());
  return table.first() + static_cast<int32_t>(symbol);
}

}  // namespace engram::encoders
