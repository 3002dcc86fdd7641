// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/coded_moments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxLags = 5;

/// How far back what came before is looked at, as shares of the context: closer where it is newer.
constexpr std::array<double, kMaxLags> kLags{0, 0.1, 0.3, 0.5, 1};

std::vector<Duration> lags_of(Duration context) {
  if (context == Duration::zero()) return {Duration::zero()};
  std::vector<Duration> lags;
  for (const double share : kLags)
    lags.push_back(Duration(static_cast<int64_t>(share * static_cast<double>(context.count()))));
  return lags;
}

/// Compares codes of images. Sums are whole numbers, so that equal codes have the distance 0.
struct ByteCodes {
  using Sum = int32_t;
  const int8_t* codes;

  [[nodiscard]] Sum square_distance(const int8_t* a, size_t moment) const {
    const int8_t* const b = codes + moment * kCodeSize;
    Sum sum = 0;
    for (size_t i = 0; i < kCodeSize; ++i) {
      const auto difference = static_cast<int16_t>(a[i] - b[i]);
      sum += difference * difference;
    }
    return sum;
  }
  [[nodiscard]] const int8_t* of(size_t moment) const { return codes + moment * kCodeSize; }
};

/// Compares codes of numbers, with eight sums side by side, which the compiler keeps in registers.
struct FloatCodes {
  using Sum = float;
  const float* codes;
  size_t numbers;

  [[nodiscard]] Sum square_distance(const float* a, size_t moment) const {
    constexpr size_t kSide = 8;
    const float* const b = codes + moment * numbers;
    std::array<float, kSide> sums{};
    size_t i = 0;
    for (; i + kSide <= numbers; i += kSide)
      for (size_t j = 0; j < kSide; ++j) {
        const float difference = a[i + j] - b[i + j];
        sums[j] += difference * difference;
      }
    Sum sum = 0;
    for (; i < numbers; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    for (const float one : sums) sum += one;
    return sum;
  }
  [[nodiscard]] const float* of(size_t moment) const { return codes + moment * numbers; }
};

/// All lags of a moment at once: what lies a second before it is in the processor's cache still.
template <typename Codes>
void add_squares(const CodedMoments& coded, const Codes& codes, size_t moment,
                 std::span<const Duration> lags, float unit, std::vector<float>& squares) {
  std::array<decltype(codes.of(0)), kMaxLags> own{};
  for (size_t k = 0; k < lags.size(); ++k) own[k] = codes.of(coded.before(moment, lags[k]));
  for (const Sequence& recording : coded.recordings) {
    std::array<size_t, kMaxLags> at{};
    at.fill(recording.first);
    for (size_t i = recording.first; i < recording.end; ++i) {
      typename Codes::Sum sum = codes.square_distance(own[0], i);
      for (size_t k = 1; k < lags.size(); ++k) {
        while (at[k] < i && coded.times[at[k] + 1] <= coded.times[i] - lags[k]) ++at[k];
        sum += codes.square_distance(own[k], at[k]);
      }
      squares[i] = static_cast<float>(sum) / unit;
    }
  }
}

template <typename Number>
double spread_of(std::span<const Number> codes, size_t numbers) {
  double squares = 0;
  std::vector<double> sums(numbers, 0.0);
  for (size_t row = 0; row < codes.size(); row += numbers)
    for (size_t j = 0; j < numbers; ++j) {
      const auto number = static_cast<double>(codes[row + j]);
      squares += number * number;
      sums[j] += number;
    }
  const auto rows = static_cast<double>(std::max<size_t>(codes.size() / numbers, 1));
  double mean_square = 0;
  for (const double sum : sums) mean_square += sum / rows * (sum / rows);
  // Twice the variance, because both of a pair deviate.
  const double variance = std::max(squares / rows - mean_square, 0.0);
  return std::sqrt(2 * variance / static_cast<double>(numbers));
}

template <typename Number>
void append_row(const std::vector<Number>& from, size_t row, size_t numbers,
                std::vector<Number>& to) {
  if (from.empty()) return;
  const auto first = from.begin() + static_cast<std::ptrdiff_t>(row * numbers);
  to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(numbers));
}

}  // namespace

std::optional<size_t> CodedMoments::at_or_before(Time time) const {
  const auto after = std::ranges::upper_bound(times, time);
  if (after == times.begin()) return std::nullopt;
  return static_cast<size_t>(after - times.begin()) - 1;
}

size_t CodedMoments::recording_of(size_t moment) const {
  const auto after = std::ranges::upper_bound(recordings, moment, {}, &Sequence::first);
  return static_cast<size_t>(after - recordings.begin()) - 1;
}

size_t CodedMoments::before(size_t moment, Duration lag) const {
  const size_t first = recordings[recording_of(moment)].first;
  const auto at = at_or_before(times[moment] - lag);
  return at ? std::max(*at, first) : first;
}

void CodedMoments::finish() {
  recordings = cut_recordings(times);
  spread = coded_by == CodedBy::kImages ? spread_of(std::span<const int8_t>(bytes), numbers)
                                        : spread_of(std::span<const float>(floats), numbers);
}

void CodedMoments::finish_from(size_t finished) {
  constexpr size_t kLast = 200'000;
  // What was finished of a part says little of how far apart all are.
  if (size() <= kLast || finished < size() / 2) {
    finish();
    return;
  }
  // From the beginning of a recording on, because what began before may go on.
  const size_t changed = std::min(finished, size() - kLast);
  size_t first = changed;
  while (!recordings.empty() && recordings.back().end >= changed) {
    first = std::min(first, recordings.back().first);
    recordings.pop_back();
  }
  for (const Sequence& one : cut_recordings(std::span(times).subspan(first)))
    recordings.push_back({one.first + first, one.end + first});
}

void CodedMoments::truncate(size_t count) {
  times.resize(count);
  if (!bytes.empty()) bytes.resize(count * numbers);
  if (!floats.empty()) floats.resize(count * numbers);
  while (!recordings.empty() && recordings.back().first >= count) recordings.pop_back();
  if (!recordings.empty()) recordings.back().end = std::min(recordings.back().end, count);
}

std::vector<float> CodedMoments::square_distances(size_t moment, Duration context) const {
  const auto lags = lags_of(context);
  const double unit =
      spread * spread * static_cast<double>(numbers) * static_cast<double>(lags.size());
  std::vector<float> squares(size(), 0.0f);
  if (unit == 0) return squares;
  if (coded_by == CodedBy::kImages)
    add_squares(*this, ByteCodes{bytes.data()}, moment, lags, static_cast<float>(unit), squares);
  else
    add_squares(*this, FloatCodes{floats.data(), numbers}, moment, lags, static_cast<float>(unit),
                squares);
  return squares;
}

std::vector<float> CodedMoments::square_distances(std::span<const int8_t> code) const {
  ENGRAM_CHECK(coded_by == CodedBy::kImages && code.size() == kCodeSize,
               "a code of {} numbers cannot be compared", code.size());
  const ByteCodes codes{bytes.data()};
  const double unit = spread * spread * static_cast<double>(numbers);
  std::vector<float> squares(size(), 0.0f);
  for (size_t i = 0; i < size() && unit > 0; ++i)
    squares[i] =
        static_cast<float>(codes.square_distance(code.data(), i)) / static_cast<float>(unit);
  return squares;
}

CodedMoments CodedMoments::only(const TimeWindows& at) const {
  CodedMoments some{coded_by, space, is_stored_space, {}, numbers, {}, {}, {}, 0};
  for (size_t i = 0; i < size(); ++i) {
    if (!at.contains(times[i])) continue;
    if (coded_by == CodedBy::kNumbers && !at.contains(times[before(i, kChangeLag)])) continue;
    some.times.push_back(times[i]);
    append_row(bytes, i, numbers, some.bytes);
    append_row(floats, i, numbers, some.floats);
  }
  some.finish();
  return some;
}

}  // namespace engram::ltm
