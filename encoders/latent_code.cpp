// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_code.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

namespace engram::encoders {

namespace {

constexpr size_t kChecksumBytes = sizeof(uint32_t);
constexpr int32_t kLargestCounted = 32767;

uint32_t checksum_of(std::span<const std::byte> bytes) {
  return static_cast<uint32_t>(XXH3_64bits(bytes.data(), bytes.size()));
}

size_t contexts_of(const LatentGrid& grid) {
  return grid.height * grid.width == 1 ? 1 : LatentCoder::kContexts;
}

size_t table_count(std::span<const LatentGrid> grids) {
  size_t count = 0;
  for (const LatentGrid& grid : grids)
    count += static_cast<size_t>(grid.channels) * contexts_of(grid);
  return count;
}

size_t value_count(std::span<const LatentGrid> grids) {
  size_t count = 0;
  for (const LatentGrid& grid : grids) count += grid.count();
  return count;
}

template <size_t N>
size_t class_of(int64_t size, const std::array<int64_t, N>& limits) {
  return static_cast<size_t>(std::upper_bound(limits.begin(), limits.end(), size) - limits.begin());
}

/// Which of a channel's tables belongs to a place, from the values before it in walk order.
class Neighbourhood {
 public:
  Neighbourhood(const LatentGrid& grid, const int32_t* values) : grid_(grid), values_(values) {}

  [[nodiscard]] size_t context(int channel, int y, int x) const {
    if (contexts_of(grid_) == 1) return 0;
    const int64_t around = 2 * (size(channel, y, x - 1) + size(channel, y - 1, x)) +
                           size(channel, y - 1, x - 1) + size(channel, y - 1, x + 1);
    int64_t below = 0;
    for (int i = 1; i <= 4; ++i) below += size(channel - i, y, x);
    static constexpr std::array<int64_t, 5> kAround{1, 3, 6, 12, 24};
    static constexpr std::array<int64_t, 3> kBelow{1, 3, 8};
    return class_of(around, kAround) * 4 + class_of(below, kBelow);
  }

 private:
  [[nodiscard]] int64_t size(int channel, int y, int x) const {
    if (channel < 0 || y < 0 || x < 0 || x >= grid_.width) return 0;
    const auto at = (static_cast<size_t>(channel) * static_cast<size_t>(grid_.height) +
                     static_cast<size_t>(y)) *
                        static_cast<size_t>(grid_.width) +
                    static_cast<size_t>(x);
    return std::abs(static_cast<int64_t>(values_[at]));
  }

  const LatentGrid& grid_;
  const int32_t* values_;
};

/// Calls visit(index of the value, index of its table) for every value in walk order.
template <typename Visit>
void walk(std::span<const LatentGrid> grids, const int32_t* values, Visit visit) {
  size_t first = 0;
  size_t table = 0;
  for (const LatentGrid& grid : grids) {
    const Neighbourhood neighbourhood(grid, values + first);
    size_t at = first;
    for (int channel = 0; channel < grid.channels; ++channel, table += contexts_of(grid))
      for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x)
          visit(at++, table + neighbourhood.context(channel, y, x));
    first += grid.count();
  }
}

}  // namespace

Result<LatentCoder> LatentCoder::create(std::vector<LatentGrid> grids,
                                        std::vector<FrequencyTable> tables) {
  if (tables.size() != table_count(grids))
    return data_loss("latent coder: found {} tables, needs {}", tables.size(), table_count(grids));
  LatentCoder coder;
  coder.grids_ = std::move(grids);
  coder.tables_ = std::move(tables);
  return coder;
}

size_t LatentCoder::count() const {
  return value_count(grids_);
}

std::vector<std::byte> LatentCoder::encode(std::span<const int32_t> values) const {
  ENGRAM_CHECK(values.size() == count(), "{} values, needs {}", values.size(), count());
  RangeEncoder encoder;
  walk(grids_, values.data(),
       [&](size_t at, size_t table) { encoder.put(tables_[table], values[at]); });
  std::vector<std::byte> code = encoder.finish();
  const uint32_t checksum = checksum_of(code);
  const auto tail = std::as_bytes(std::span(&checksum, 1));
  code.insert(code.end(), tail.begin(), tail.end());
  return code;
}

Result<std::vector<int32_t>> LatentCoder::decode(std::span<const std::byte> code) const {
  if (code.size() < kChecksumBytes)
    return data_loss("latent code: found {} bytes, needs at least {}", code.size(), kChecksumBytes);
  const auto body = code.first(code.size() - kChecksumBytes);
  uint32_t stored = 0;
  std::memcpy(&stored, code.data() + body.size(), kChecksumBytes);
  if (stored != checksum_of(body))
    return data_loss("latent code: checksum {:08x} of {} bytes does not fit, needs {:08x}",
                     checksum_of(body), body.size(), stored);
  RangeDecoder decoder(body);
  std::vector<int32_t> values(count());
  walk(grids_, values.data(),
       [&](size_t at, size_t table) { values[at] = decoder.get(tables_[table]); });
  return values;
}

LatentStatistics::LatentStatistics(std::vector<LatentGrid> grids)
    : grids_(std::move(grids)), histograms_(table_count(grids_)) {}

void LatentStatistics::Histogram::add(int32_t value) {
  value = std::clamp(value, -kLargestCounted, kLargestCounted);
  if (counts.empty()) first = value;
  if (value < first) {
    counts.insert(counts.begin(), static_cast<size_t>(first - value), 0);
    first = value;
  }
  const auto at = static_cast<size_t>(value - first);
  if (at >= counts.size()) counts.resize(at + 1);
  ++counts[at];
}

void LatentStatistics::add(std::span<const int32_t> values) {
  ENGRAM_CHECK(values.size() == value_count(grids_), "{} values", values.size());
  walk(grids_, values.data(), [&](size_t at, size_t table) { histograms_[table].add(values[at]); });
}

LatentCoder LatentStatistics::coder() const {
  std::vector<FrequencyTable> tables;
  tables.reserve(histograms_.size());
  for (const Histogram& histogram : histograms_)
    tables.push_back(FrequencyTable::from_counts(histogram.first, histogram.counts));
  auto coder = LatentCoder::create(grids_, std::move(tables));
  ENGRAM_CHECK(coder.ok(), "{}", coder.status().message());
  return std::move(coder).value();
}

}  // namespace engram::encoders
