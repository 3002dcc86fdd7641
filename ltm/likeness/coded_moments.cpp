// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/coded_moments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "ltm/likeness/gather_space.h"
#include "ltm/likeness/seen_image.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxNumberMoments = 100'000;
/// Numbers of all codes together, so that arrays of a thousand numbers take no gigabytes.
constexpr size_t kMaxNumbers = size_t{1} << 25;
constexpr Duration kChangeLag = std::chrono::milliseconds(400);

std::vector<Time> entry_times(const std::vector<SnapshotEntry>& entries) {
  std::vector<Time> times;
  times.reserve(entries.size());
  for (const SnapshotEntry& entry : entries) times.push_back(entry.time);
  return times;
}

/// Reads the codes of the images of one entity.
class ImageCodes {
 public:
  ImageCodes(StorePast& past, const MemoryId& entity, const ProgressSink& progress,
             const std::stop_token& stop)
      : past_(past), entity_(entity), progress_(progress), stop_(stop) {}

  Result<CodedMoments> run(const std::vector<SnapshotEntry>& entries) {
    ENGRAM_ASSIGN_OR_RETURN(images_, past_.of(entity_));
    ENGRAM_RETURN_IF_ERROR(find_space(entries));
    coded_.numbers = kCodeSize;
    const StoredCodes stored = StoredCodes::read(past_.store(), entity_, coded_.space.id());
    for (const SnapshotEntry& entry : entries) {
      if (stop_.stop_requested()) return cancelled("'{}': coding images", entity_.to_string());
      if (const auto code = stored.find(entry); !code.empty()) {
        append(entry.time, code);
      } else {
        ENGRAM_RETURN_IF_ERROR(compute(entry.time, entries.size()));
      }
    }
    coded_.recordings = cut_recordings(coded_.times);
    return std::move(coded_);
  }

 private:
  Status find_space(const std::vector<SnapshotEntry>& entries) {
    if (const auto bytes = read_entity_index(past_.store().path(), entity_, kSpaceIndex);
        bytes.ok())
      if (auto space = LikenessSpace::unpack(bytes->bytes()); space.ok()) {
        coded_.space = *std::move(space);
        coded_.is_stored_space = true;
        return {};
      }
    ENGRAM_ASSIGN_OR_RETURN(coded_.space,
                            learn_space(past_, entity_, entry_times(entries), progress_,
                                        [this] { return stop_.stop_requested(); }));
    return {};
  }

  void append(Time time, std::span<const int8_t> code) {
    coded_.times.push_back(time);
    coded_.codes.insert(coded_.codes.end(), code.begin(), code.end());
  }

  Status compute(Time time, size_t total) {
    if (progress_)
      progress_({"code images of " + entity_.to_string(), coded_.times.size(), total, "", -1});
    ENGRAM_ASSIGN_OR_RETURN(const auto seen, see(*images_, time));
    if (!seen || seen->size != coded_.space.size) return {};
    append(time, coded_.space.code(seen->descriptor));
    ++coded_.computed;
    return {};
  }

  StorePast& past_;
  const MemoryId& entity_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::unique_ptr<EntityPast> images_;
  CodedMoments coded_;
};

/// Makes columns that never change 0, and gives all others the mean 0 and the deviation 1.
void standardise_columns(CodedMoments& coded) {
  const auto rows = static_cast<double>(coded.size());
  for (size_t j = 0; j < coded.numbers; ++j) {
    double sum = 0, squares = 0;
    for (size_t i = 0; i < coded.size(); ++i) sum += coded.codes[i * coded.numbers + j];
    const double mean = sum / rows;
    for (size_t i = 0; i < coded.size(); ++i)
      squares += std::pow(coded.codes[i * coded.numbers + j] - mean, 2);
    const double deviation = std::sqrt(squares / rows);
    for (size_t i = 0; i < coded.size(); ++i) {
      float& number = coded.codes[i * coded.numbers + j];
      number = deviation > 0 ? static_cast<float>((number - mean) / deviation) : 0.0f;
    }
  }
}

/// Puts the change of each number behind its value.
void append_changes(CodedMoments& coded) {
  const auto before = coded.lagged(kChangeLag);
  std::vector<float> with_changes;
  with_changes.reserve(2 * coded.codes.size());
  for (size_t i = 0; i < coded.size(); ++i) {
    const auto now = coded.code(i), then = coded.code(before[i]);
    with_changes.insert(with_changes.end(), now.begin(), now.end());
    std::ranges::transform(now, then, std::back_inserter(with_changes), std::minus<>());
  }
  coded.codes = std::move(with_changes);
  coded.numbers *= 2;
}

Result<CodedMoments> number_codes(StorePast& past, const MemoryId& entity,
                                  const std::vector<SnapshotEntry>& entries, size_t numbers,
                                  const ProgressSink& progress, const std::stop_token& stop) {
  CodedMoments coded;
  coded.coded_by = CodedBy::kNumbers;
  coded.numbers = numbers;
  ENGRAM_ASSIGN_OR_RETURN(const auto values, past.of(entity));
  std::vector<double> first;
  const size_t count =
      std::min({entries.size(), kMaxNumberMoments, std::max<size_t>(kMaxNumbers / numbers, 2)});
  for (size_t i = 0; i < count; ++i) {
    if (stop.stop_requested()) return cancelled("'{}': reading numbers", entity.to_string());
    if (progress) progress({"read numbers of " + entity.to_string(), i, count, "", -1});
    const Time time = entries[i * entries.size() / count].time;
    ENGRAM_ASSIGN_OR_RETURN(const auto row, numbers_at(*values, time));
    const bool is_finite =
        std::ranges::all_of(row, [](double number) { return std::isfinite(number); });
    if (row.size() != numbers || !is_finite) continue;  // Another layout cannot be compared.
    if (coded.times.empty()) first = row;
    coded.times.push_back(time);
    // Floats tell metres of a millimetre apart, but not of a position on Earth.
    std::ranges::transform(row, first, std::back_inserter(coded.codes), std::minus<>());
  }
  coded.recordings = cut_recordings(coded.times);
  append_changes(coded);
  standardise_columns(coded);
  return coded;
}

/// How far back what came before is looked at, as shares of the context: closer where it is newer.
constexpr std::array<double, 5> kLags{0, 0.1, 0.3, 0.5, 1};

std::vector<Duration> lags_of(Duration context) {
  if (context == Duration::zero()) return {Duration::zero()};
  std::vector<Duration> lags;
  for (const double share : kLags)
    lags.push_back(Duration(static_cast<int64_t>(share * static_cast<double>(context.count()))));
  return lags;
}

/// With eight sums side by side, which the compiler keeps in one register.
double square_distance(std::span<const float> a, std::span<const float> b) {
  constexpr size_t kSide = 8;
  std::array<float, kSide> sums{};
  size_t i = 0;
  for (; i + kSide <= a.size(); i += kSide)
    for (size_t j = 0; j < kSide; ++j) {
      const float difference = a[i + j] - b[i + j];
      sums[j] += difference * difference;
    }
  double sum = 0;
  for (; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  for (const float one : sums) sum += one;
  return sum;
}

}  // namespace

std::optional<size_t> CodedMoments::at_or_before(Time time) const {
  const auto after = std::ranges::upper_bound(times, time);
  if (after == times.begin()) return std::nullopt;
  return static_cast<size_t>(after - times.begin()) - 1;
}

std::vector<size_t> CodedMoments::lagged(Duration lag) const {
  std::vector<size_t> before(size());
  for (const Sequence& recording : recordings) {
    size_t at = recording.first;
    for (size_t i = recording.first; i < recording.end; ++i) {
      while (at < i && times[at + 1] <= times[i] - lag) ++at;
      before[i] = at;
    }
  }
  return before;
}

double CodedMoments::spread() const {
  double squares = 0;
  std::vector<double> sums(numbers, 0.0);
  for (size_t i = 0; i < codes.size(); ++i) {
    squares += static_cast<double>(codes[i]) * codes[i];
    sums[i % numbers] += codes[i];
  }
  const auto rows = static_cast<double>(std::max<size_t>(size(), 1));
  double mean_square = 0;
  for (const double sum : sums) mean_square += sum / rows * (sum / rows);
  // Twice the variance, because both of a pair deviate.
  const double variance = std::max(squares / rows - mean_square, 0.0);
  return std::sqrt(2 * variance / static_cast<double>(std::max<size_t>(numbers, 1)));
}

std::vector<double> CodedMoments::square_distances(size_t moment, Duration context) const {
  const auto lags = lags_of(context);
  const double distance = spread();
  const double unit =
      distance * distance * static_cast<double>(numbers) * static_cast<double>(lags.size());
  std::vector<double> squares(size(), 0.0);
  if (unit == 0) return squares;
  for (const Duration lag : lags) {
    const auto before = lagged(lag);
    const auto own = code(before[moment]);
    for (size_t i = 0; i < size(); ++i) squares[i] += square_distance(own, code(before[i])) / unit;
  }
  return squares;
}

std::vector<double> CodedMoments::square_distances(std::span<const float> from) const {
  const double distance = spread();
  const double unit = distance * distance * static_cast<double>(numbers);
  std::vector<double> squares(size(), 0.0);
  for (size_t i = 0; i < size() && unit > 0; ++i)
    squares[i] = square_distance(from, code(i)) / unit;
  return squares;
}

Result<CodedMoments> code_moments(StorePast& past, const MemoryId& entity,
                                  const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* const found, past.store().index(entity));
  const std::vector<SnapshotEntry>& entries = *found;
  if (entries.empty()) return not_found("'{}': has no snapshots", entity.to_string());
  ENGRAM_ASSIGN_OR_RETURN(const auto example, past.of(entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto seen, see(*example, entries.back().time));
  if (seen) return ImageCodes(past, entity, progress, stop).run(entries);
  ENGRAM_ASSIGN_OR_RETURN(const auto numbers, numbers_at(*example, entries.back().time));
  if (numbers.empty())
    return failed_precondition("'{}': has neither images nor numbers to compare",
                               entity.to_string());
  return number_codes(past, entity, entries, numbers.size(), progress, stop);
}

}  // namespace engram::ltm
