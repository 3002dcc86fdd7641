// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/moment_coder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include <fmt/format.h>

#include "ltm/likeness/gather_space.h"
#include "ltm/likeness/seen_image.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxNumberMoments = 100'000;
/// Numbers of all codes together, so that arrays of a thousand numbers take no gigabytes.
constexpr size_t kMaxNumbers = size_t{1} << 25;

bool is_unsealed(const SnapshotEntry& entry) {
  return entry.recorded && entry.recorded->rows == 0;
}

/// Tells where the image of a sealed moment lies from all other places: that of its code.
uint64_t place_of(const Manifest& manifest, const SnapshotEntry& entry) {
  constexpr uint64_t kOdd = 0x9E3779B97F4A7C15;
  const SnapshotEntry::Location& at = entry.latent ? *entry.latent : *entry.recorded;
  return manifest.segments[at.source].checksum + kOdd * (at.at + 1);
}

/// Makes columns that never change 0, and gives all others the mean 0 and the deviation 1.
void standardise_columns(CodedMoments& coded) {
  const auto rows = static_cast<double>(coded.size());
  for (size_t j = 0; j < coded.numbers; ++j) {
    double sum = 0, squares = 0;
    for (size_t i = 0; i < coded.size(); ++i) sum += coded.floats[i * coded.numbers + j];
    const double mean = sum / rows;
    for (size_t i = 0; i < coded.size(); ++i)
      squares += std::pow(coded.floats[i * coded.numbers + j] - mean, 2);
    const double deviation = std::sqrt(squares / rows);
    for (size_t i = 0; i < coded.size(); ++i) {
      float& number = coded.floats[i * coded.numbers + j];
      number = deviation > 0 ? static_cast<float>((number - mean) / deviation) : 0.0f;
    }
  }
}

/// Puts the change of each number behind its value.
void append_changes(CodedMoments& coded) {
  std::vector<float> with_changes;
  with_changes.reserve(2 * coded.floats.size());
  const auto row = [&coded](size_t moment) {
    return std::span(coded.floats).subspan(moment * coded.numbers, coded.numbers);
  };
  for (const Sequence& recording : coded.recordings) {
    size_t at = recording.first;
    for (size_t i = recording.first; i < recording.end; ++i) {
      while (at < i && coded.times[at + 1] <= coded.times[i] - kChangeLag) ++at;
      with_changes.insert(with_changes.end(), row(i).begin(), row(i).end());
      std::ranges::transform(row(i), row(at), std::back_inserter(with_changes), std::minus<>());
    }
  }
  coded.floats = std::move(with_changes);
  coded.numbers *= 2;
}

void append_row(const std::vector<float>& row, CodedMoments& coded) {
  if (coded.coded_by == CodedBy::kNumbers)
    coded.floats.insert(coded.floats.end(), row.begin(), row.end());
  else
    for (const float number : row) coded.bytes.push_back(static_cast<int8_t>(number));
}

/// Copies moments [first, end) of others with equally long rows.
void append_moments(const CodedMoments& from, size_t first, size_t end, CodedMoments& to) {
  const auto copy = [](const auto& source, size_t begin, size_t stop, auto& target) {
    if (source.empty()) return;
    target.insert(target.end(), source.begin() + static_cast<std::ptrdiff_t>(begin),
                  source.begin() + static_cast<std::ptrdiff_t>(stop));
  };
  copy(from.times, first, end, to.times);
  copy(from.bytes, first * from.numbers, end * from.numbers, to.bytes);
  copy(from.floats, first * from.numbers, end * from.numbers, to.floats);
}

}  // namespace

/// One question.
class MomentCoder::Run {
 public:
  Run(MomentCoder& coder, ComparedPast& past, const ProgressSink& progress,
      const std::stop_token& stop)
      : coder_(coder),
        past_(past),
        store_(past.store()),
        held_(past.held(coder.entity_)),
        progress_(progress),
        stop_(stop) {}

  Result<CodedAnswer> run() {
    // Who asks may know nothing of the store: that it has no such entity is told by it.
    if (held_.empty() && !store_.has(entity())) return store_.index(entity()).status();
    ENGRAM_ASSIGN_OR_RETURN(joined_, past_.of(entity()));
    ENGRAM_ASSIGN_OR_RETURN(stored_, past_.stored(entity()));
    ENGRAM_ASSIGN_OR_RETURN(const auto last, joined_->last());
    if (!last) return not_found("'{}': has no snapshots", entity().to_string());
    ENGRAM_RETURN_IF_ERROR(find_form(*last));
    if (coder_.coded_by_ == CodedBy::kImages) ENGRAM_RETURN_IF_ERROR(find_space());
    if (coder_.generation_ != store_.manifest().generation) ENGRAM_RETURN_IF_ERROR(code_sealed());
    ENGRAM_RETURN_IF_ERROR(code_held());
    ENGRAM_RETURN_IF_ERROR(code_unsealed());
    return CodedAnswer{joined_moments(), computed_};
  }

 private:
  [[nodiscard]] const MemoryId& entity() const { return coder_.entity_; }

  void forget_codes() {
    coder_.sealed_ = nullptr;
    coder_.sealed_from_.clear();
    coder_.generation_.reset();
    coder_.unsealed_.clear();
    coder_.held_.clear();
    coder_.first_.clear();
  }

  /// What codes are made of, as the last moment tells.
  Status find_form(Time last) {
    ENGRAM_ASSIGN_OR_RETURN(const auto seen, see(*joined_, last));
    CodedBy coded_by = CodedBy::kImages;
    size_t numbers = kCodeSize;
    if (!seen) {
      coded_by = CodedBy::kNumbers;
      ENGRAM_ASSIGN_OR_RETURN(const auto row, numbers_at(*joined_, last));
      numbers = row.size();
      if (numbers == 0)
        return failed_precondition("'{}': has neither images nor numbers to compare",
                                   entity().to_string());
    }
    if (coded_by == coder_.coded_by_ && numbers == coder_.numbers_) return {};
    forget_codes();
    coder_.coded_by_ = coded_by;
    coder_.numbers_ = numbers;
    return {};
  }

  Status find_space() {
    if (auto there = read_space(store_, entity())) {
      if (!coder_.space_ || coder_.space_->id() != there->id()) forget_codes();
      coder_.space_ = std::move(there);
      coder_.is_stored_space_ = true;
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, joined_->count());
    // One that was stored and is not any more was erased.
    if (coder_.space_ && !coder_.is_stored_space_ && count < 2 * coder_.space_->snapshots)
      return {};
    forget_codes();
    coder_.space_.reset();
    coder_.is_stored_space_ = false;
    ENGRAM_ASSIGN_OR_RETURN(const auto times, all_times());
    ENGRAM_ASSIGN_OR_RETURN(coder_.space_, learn_space(past_, entity(), times, progress_,
                                                       [this] { return stop_.stop_requested(); }));
    return {};
  }

  Result<std::vector<Time>> all_times() {
    std::vector<Time> stored, held, all;
    if (store_.has(entity())) {
      ENGRAM_ASSIGN_OR_RETURN(const auto* const entries, store_.index(entity()));
      for (const SnapshotEntry& entry : *entries) stored.push_back(entry.time);
    }
    for (const SharedSnapshot& snapshot : held_) held.push_back(snapshot->time);
    std::ranges::set_union(stored, held, std::back_inserter(all));
    return all;
  }

  [[nodiscard]] CodedMoments without_moments() const {
    CodedMoments coded;
    coded.coded_by = coder_.coded_by_;
    if (coder_.coded_by_ == CodedBy::kImages) coded.space = *coder_.space_;
    coded.is_stored_space = coder_.coded_by_ == CodedBy::kImages && coder_.is_stored_space_;
    coded.numbers = coder_.numbers_;
    return coded;
  }

  /// Computes the code of a moment; empty if it has none.
  Result<Row> row_of(EntityPast& past, Time time, size_t done, size_t total) {
    const bool is_image = coder_.coded_by_ == CodedBy::kImages;
    if (stop_.stop_requested()) return cancelled("'{}': coding it", entity().to_string());
    if (progress_)
      progress_({(is_image ? "code images of " : "read numbers of ") + entity().to_string(), done,
                 total, "", -1});
    Row row;
    if (is_image) {
      ENGRAM_ASSIGN_OR_RETURN(const auto seen, see(past, time));
      if (!seen || seen->size != coder_.space_->size) return row;
      const auto code = coder_.space_->code(seen->descriptor);
      ++computed_;
      return Row(code.begin(), code.end());
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto numbers, numbers_at(past, time));
    const bool is_finite =
        std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
    // Another layout cannot be compared.
    if (numbers.size() != coder_.numbers_ || !is_finite) return row;
    if (coder_.first_.empty()) coder_.first_ = numbers;
    // Floats tell metres of a millimetre apart, but not of a position on Earth.
    std::ranges::transform(numbers, coder_.first_, std::back_inserter(row), std::minus<>());
    return row;
  }

  /// Codes what is in segments, as far as it was not before.
  Status code_sealed() {
    auto sealed = std::make_shared<CodedMoments>(without_moments());
    std::vector<uint64_t> from;
    if (coder_.sealed_) coder_.sealed_->truncate(coder_.sealed_from_.size());
    const Status coded = code_sealed(*sealed, from);
    const bool is_whole = coded.ok();
    if (!is_whole && coder_.sealed_) {
      // What was computed before is not computed again by who asks next.
      const CodedMoments& old = *coder_.sealed_;
      const size_t rest =
          sealed->times.empty()
              ? 0
              : static_cast<size_t>(std::ranges::upper_bound(old.times, sealed->times.back()) -
                                    old.times.begin());
      append_moments(old, rest, old.size(), *sealed);
      from.insert(from.end(), coder_.sealed_from_.begin() + static_cast<std::ptrdiff_t>(rest),
                  coder_.sealed_from_.end());
    }
    sealed->finish();
    coder_.sealed_ = std::move(sealed);
    coder_.sealed_from_ = std::move(from);
    coder_.generation_.reset();
    if (is_whole) coder_.generation_ = store_.manifest().generation;
    return coded;
  }

  Status code_sealed(CodedMoments& sealed, std::vector<uint64_t>& from) {
    if (!store_.has(entity())) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto* const entries, store_.index(entity()));
    const bool is_image = coder_.coded_by_ == CodedBy::kImages;
    const StoredCodes codes =
        is_image ? StoredCodes::read(store_, entity(), coder_.space_->id()) : StoredCodes();
    const size_t max_count =
        is_image ? entries->size()
                 : std::min(kMaxNumberMoments, std::max<size_t>(kMaxNumbers / coder_.numbers_, 2));
    // By powers of two, so that what was taken of fewer snapshots is taken of more, too.
    size_t step = 1;
    while (entries->size() / step > max_count) step *= 2;
    const size_t count = (entries->size() + step - 1) / step;
    for (size_t i = 0; i < count; ++i) {
      const SnapshotEntry& entry = (*entries)[i * step];
      if (is_unsealed(entry)) continue;
      const uint64_t place = place_of(store_.manifest(), entry);
      if (const auto code = codes.find(entry); !code.empty()) {
        sealed.bytes.insert(sealed.bytes.end(), code.begin(), code.end());
      } else if (const auto known = find_sealed(entry.time, place)) {
        append_moments(*coder_.sealed_, *known, *known + 1, sealed);
        sealed.times.pop_back();
      } else {
        ENGRAM_ASSIGN_OR_RETURN(const Row row, row_of(*stored_, entry.time, i, count));
        if (row.empty()) continue;
        append_row(row, sealed);
      }
      sealed.times.push_back(entry.time);
      from.push_back(place);
    }
    return {};
  }

  /// The code of a moment that was gathered before, unless another image is there now.
  [[nodiscard]] std::optional<size_t> find_sealed(Time time, uint64_t place) const {
    if (!coder_.sealed_) return std::nullopt;
    const std::vector<Time>& times = coder_.sealed_->times;
    const auto at = std::ranges::lower_bound(times, time);
    if (at == times.end() || *at != time) return std::nullopt;
    const auto index = static_cast<size_t>(at - times.begin());
    return coder_.sealed_from_[index] == place ? std::optional(index) : std::nullopt;
  }

  Status code_unsealed() {
    const auto entries = store_.unsealed(entity());
    std::map<std::pair<uint64_t, uint64_t>, Row> rows;
    for (const SnapshotEntry& entry : entries) {
      if (newer_.contains(entry.time)) continue;  // Working memory has it, and that counts.
      const std::pair key{store_.journal_number(*entry.recorded), entry.recorded->at};
      auto known = coder_.unsealed_.extract(key);
      if (!known) {
        auto row = row_of(*stored_, entry.time, rows.size(), entries.size());
        if (!row.ok()) {
          coder_.unsealed_.merge(rows);
          return row.status();
        }
        rows[key] = *std::move(row);
      } else {
        rows.insert(std::move(known));
      }
      newer_[entry.time] = &rows[key];
    }
    // What was sealed meanwhile is gathered there.
    coder_.unsealed_ = std::move(rows);
    return {};
  }

  Status code_held() {
    std::map<Time, HeldRow> rows;
    for (const SharedSnapshot& snapshot : held_) {
      auto known = coder_.held_.extract(snapshot->time);
      const bool is_same = known && !known.mapped().of.owner_before(snapshot) &&
                           !snapshot.owner_before(known.mapped().of);
      if (is_same) {
        rows.insert(std::move(known));
      } else {
        auto row = row_of(*joined_, snapshot->time, rows.size(), held_.size());
        if (!row.ok()) {
          coder_.held_.merge(rows);
          return row.status();
        }
        rows[snapshot->time] = {snapshot, *std::move(row)};
      }
      newer_[snapshot->time] = &rows[snapshot->time].row;
    }
    coder_.held_ = std::move(rows);
    return {};
  }

  static void append_newer(Time time, const Row& row, CodedMoments& all) {
    if (row.empty()) return;
    all.times.push_back(time);
    append_row(row, all);
  }

  /// Sealed moments with the newer ones among them, which count where both are.
  [[nodiscard]] std::shared_ptr<const CodedMoments> joined_moments() const {
    const bool is_image = coder_.coded_by_ == CodedBy::kImages;
    CodedMoments& sealed = *coder_.sealed_;
    const size_t count = coder_.sealed_from_.size();
    if (sealed.size() > count) {
      sealed.truncate(count);
      if (newer_.empty()) sealed.finish_from(count);
    }
    if (newer_.empty() && is_image) return coder_.sealed_;
    const bool is_behind = sealed.times.empty() || newer_.begin()->first > sealed.times.back();
    if (is_image && is_behind) {
      for (const auto& [time, row] : newer_) append_newer(time, *row, sealed);
      sealed.finish_from(count);
      return coder_.sealed_;
    }
    auto all = std::make_shared<CodedMoments>(without_moments());
    size_t next = 0;
    for (const auto& [time, row] : newer_) {
      const auto until = std::ranges::lower_bound(sealed.times, time);
      const auto end = static_cast<size_t>(until - sealed.times.begin());
      append_moments(sealed, next, end, *all);
      next = until != sealed.times.end() && *until == time ? end + 1 : end;
      append_newer(time, *row, *all);
    }
    append_moments(sealed, next, sealed.size(), *all);
    if (!is_image) {
      all->recordings = cut_recordings(all->times);
      append_changes(*all);
      standardise_columns(*all);
    }
    all->finish();
    return all;
  }

  MomentCoder& coder_;
  ComparedPast& past_;
  StoreReader& store_;
  const std::vector<SharedSnapshot>& held_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::unique_ptr<EntityPast> joined_;
  std::unique_ptr<EntityPast> stored_;  ///< Null if the store has nothing of the entity.
  std::map<Time, const Row*> newer_;    ///< Codes of what is in no segment.
  uint64_t computed_ = 0;
};

Result<CodedAnswer> MomentCoder::code(ComparedPast& past, const ProgressSink& progress,
                                      const std::stop_token& stop) {
  return Run(*this, past, progress, stop).run();
}

}  // namespace engram::ltm
