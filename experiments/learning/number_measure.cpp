// SPDX-License-Identifier: Apache-2.0
#include "learning/number_measure.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "ltm/codec/column_codec.h"
#include "ltm/codec/zstd.h"
#include "ltm/core/check.h"

namespace engram::experiments {

namespace {

constexpr int kZstdLevel = 19;
/// The maximum step, so that the difference of two steps fits 32 bits.
constexpr double kMaxSteps = 1 << 30;

/// Whole numbers in the form that a compressor gets.
struct Stored {
  idf::ElementType type;
  std::vector<std::byte> bytes;
};

/// Also true for equal NaN, unlike operator==.
bool has_same_bits(double a, double b) {
  return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
}

/// Returns the steps column by column. Unit: twice the bound.
Result<std::vector<int32_t>> steps_of(const NumberRecording& recording, double bound) {
  std::vector<int32_t> steps;
  const size_t width = recording.columns.size();
  for (size_t column = 0; column < width; ++column)
    for (size_t at = column; at < recording.rows.size(); at += width) {
      const double step = std::nearbyint(recording.rows[at] / (2 * bound));
      if (!(std::abs(step) < kMaxSteps))
        return invalid_argument("recording '{}', column '{}': {} is {} steps, needs less than {}",
                                recording.name, recording.columns[column], recording.rows[at], step,
                                kMaxSteps);
      steps.push_back(static_cast<int32_t>(step));
    }
  return steps;
}

std::vector<int32_t> differences_of(const std::vector<int32_t>& steps, size_t column_rows) {
  std::vector<int32_t> result = steps;
  for (size_t i = 0; i < steps.size(); ++i)
    if (i % column_rows != 0) result[i] -= steps[i - 1];
  return result;
}

template <typename T>
std::vector<std::byte> bytes_as(std::span<const int32_t> values) {
  std::vector<T> narrow;
  for (const int32_t value : values) narrow.push_back(static_cast<T>(value));
  const auto bytes = std::as_bytes(std::span(narrow));
  return {bytes.begin(), bytes.end()};
}

Stored narrowest(std::span<const int32_t> values) {
  const bool is_short = std::ranges::all_of(
      values, [](int32_t value) { return value == static_cast<int16_t>(value); });
  return is_short ? Stored{idf::ElementType::kInt16, bytes_as<int16_t>(values)}
                  : Stored{idf::ElementType::kInt32, bytes_as<int32_t>(values)};
}

double zstd_bytes(std::span<const std::byte> bytes) {
  return static_cast<double>(ltm::compress_zstd(bytes, kZstdLevel).size());
}

Status add_recording(const NumberRecording& recording, double bound, RivalBytes& sum) {
  const std::vector<float> floats(recording.rows.begin(), recording.rows.end());
  ENGRAM_ASSIGN_OR_RETURN(const auto steps, steps_of(recording, bound));
  const Stored stored = narrowest(steps);
  sum.floats += zstd_bytes(std::as_bytes(std::span(floats)));
  sum.differences += zstd_bytes(narrowest(differences_of(steps, recording.count())).bytes);
  sum.steps += static_cast<double>(ltm::compress_column(stored.type, stored.bytes).size());
  return {};
}

}  // namespace

Result<double> largest_error(const std::string& name, std::span<const double> rows,
                             std::span<const double> decoded, double bound) {
  ENGRAM_CHECK(rows.size() == decoded.size(), "{} numbers beside {}", rows.size(), decoded.size());
  double largest = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (has_same_bits(rows[i], decoded[i])) continue;
    const double error = std::abs(rows[i] - decoded[i]);
    if (!(error <= bound))
      return data_loss("recording '{}': number {} of a block, {}, decodes to {}, needs {} or less",
                       name, i, rows[i], decoded[i], bound);
    largest = std::max(largest, error);
  }
  return largest;
}

Result<RivalBytes> rival_bytes(std::span<const NumberRecording> recordings, double bound) {
  RivalBytes sum;
  for (const NumberRecording& recording : recordings)
    ENGRAM_RETURN_IF_ERROR(add_recording(recording, bound, sum));
  return sum;
}

}  // namespace engram::experiments
