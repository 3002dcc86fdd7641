// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>

#include "ltm/reflection/looks.h"
#include "ltm/reflection/robust.h"

namespace engram::ltm {

namespace {

constexpr size_t kMinFrozenRows = 24;  ///< Rows that are needed to say what is usual.
/// Share of equal neighbours up to which an entity changes usually.
constexpr double kChangingShare = 0.05;
/// Rows that stand still, and are not only the same value twice.
constexpr size_t kFrozenRun = 5;
/// Share of copies up to which they are worth telling.
constexpr double kCopiedShare = 0.2;
/// Snapshots that come again one after the other, while there was motion.
constexpr size_t kCopiedRun = 3;
/// Motion, as a share of the usual one.
constexpr double kCopiedMotion = 0.05;
/// The change of speed at an end of such a piece, in those around it.
constexpr double kCopiedLeap = 6;
/// The same for entities that often rest: then both ends must be abrupt.
constexpr size_t kAbruptRun = 3;

/// Rows `first` to `last` are equal.
struct EqualRun {
  size_t first = 0;
  size_t last = 0;

  [[nodiscard]] size_t rows() const { return last - first + 1; }
};

template <typename IsEqual>
std::vector<EqualRun> find_equal_runs(size_t rows, const IsEqual& is_equal_to_last) {
  std::vector<EqualRun> runs;
  for (size_t i = 1; i < rows; ++i) {
    if (!is_equal_to_last(i)) continue;
    if (!runs.empty() && runs.back().last == i - 1)
      runs.back().last = i;
    else
      runs.push_back({i - 1, i});
  }
  return runs;
}

/// Whether neighbours usually differ. The longest runs do not count, because a fault would hide
/// itself; neither does the begin, where a robot may not have moved yet.
bool changes_usually(std::vector<EqualRun> runs, size_t rows) {
  constexpr size_t kLeftOut = 3;
  std::erase_if(runs, [](const EqualRun& run) { return run.first == 0; });
  std::ranges::sort(runs, std::greater(), &EqualRun::rows);
  size_t equal = 0;
  for (size_t i = kLeftOut; i < runs.size(); ++i) equal += runs[i].rows() - 1;
  size_t left_out = 0;
  for (size_t i = 0; i < std::min(kLeftOut, runs.size()); ++i) left_out += runs[i].rows();
  return static_cast<double>(equal) <= kChangingShare * static_cast<double>(rows) &&
         4 * left_out < rows;
}

/// How the quantities of a block move, each element in its usual speed.
struct RelativeMotion {
  std::vector<double> speeds;  ///< The largest of each row.
  std::vector<double> leaps;   ///< The largest change of speed.
};

RelativeMotion relative_motion(const SeriesBlock& block) {
  RelativeMotion motion{std::vector<double>(block.rows(), 0.0),
                        std::vector<double>(block.rows(), 0.0)};
  for (const NumberColumn& column : block.numbers) {
    if (column.is_discrete()) continue;
    for (size_t k = 0; k < column.width; ++k) {
      std::vector<double> steps(column.rows.size(), 0.0), moving;
      for (size_t i = 1; i < column.rows.size(); ++i) {
        const double dt = 1e-9 * static_cast<double>(block.times[column.rows[i]] -
                                                     block.times[column.rows[i - 1]]);
        steps[i] = (column.at(i, k) - column.at(i - 1, k)) / std::max(dt, 0.3 * block.step_s);
        if (!std::isfinite(steps[i])) steps[i] = 0;
        if (steps[i] != 0) moving.push_back(std::abs(steps[i]));
      }
      const double usual = quantile(spread_sample(moving), 0.9);
      if (usual <= 0) continue;
      for (size_t i = 1; i < steps.size(); ++i) {
        double& speed = motion.speeds[column.rows[i]];
        double& leap = motion.leaps[column.rows[i]];
        speed = std::max(speed, std::abs(steps[i]) / usual);
        leap = std::max(leap, std::abs(steps[i] - steps[i - 1]) / usual);
      }
    }
  }
  return motion;
}

class FrozenLook {
 public:
  FrozenLook(const SeriesBlock& block, EntityReflection& entity, FindingList& findings)
      : block_(block), entity_(entity), findings_(findings) {}

  void look_at_values() {
    const auto& hashes = block_.value_hashes;
    const auto runs =
        find_equal_runs(block_.rows(), [&](size_t i) { return hashes[i] == hashes[i - 1]; });
    entity_.looked_at.insert(ReflectionKind::kFrozen);
    if (!changes_usually(runs, block_.rows())) return look_for_abrupt_ends(runs);
    entity_.looked_at.insert(ReflectionKind::kDuplicate);
    const RelativeMotion motion = relative_motion(block_);
    const std::vector<double>& speeds = motion.speeds;
    for (const EqualRun& run : runs) {
      if (run.first == 0) continue;
      if (run.rows() >= kFrozenRun)
        add(ReflectionKind::kFrozen, run, "", "new values in each snapshot");
      else if (is_odd_time(run) || moves_around(run, speeds))
        add(ReflectionKind::kDuplicate, run, "", "another value");
    }
    look_for_copies(motion);
  }

  /// Snapshots that are the same in everything, their times and links included.
  void look_at_events() {
    if (!block_.has_identity || block_.rows() < 2) return;
    entity_.looked_at.insert(ReflectionKind::kDuplicate);
    std::unordered_map<uint64_t, size_t> met;
    std::vector<std::pair<size_t, size_t>> copies;
    for (size_t i = 0; i < block_.rows(); ++i)
      if (const auto [known, is_new] = met.emplace(block_.full_hashes[i], i); !is_new)
        copies.emplace_back(known->second, i);
    // What says the same all the time means to.
    if (static_cast<double>(copies.size()) > kCopiedShare * static_cast<double>(block_.rows()))
      return;
    for (const auto& [original, copy] : copies) add_copy(original, copy, copy);
  }

  void look_at_images() {
    if (block_.images.empty()) return;
    const RelativeMotion motion = relative_motion(block_);
    const std::vector<double>& speeds = motion.speeds;
    for (const ImageColumn& column : block_.images) {
      if (column.rows.size() < kMinFrozenRows) continue;
      entity_.looked_at.insert(ReflectionKind::kFrozen);
      const auto runs = find_equal_runs(
          column.rows.size(), [&](size_t i) { return column.hashes[i] == column.hashes[i - 1]; });
      if (!changes_usually(runs, column.rows.size())) continue;
      for (const EqualRun& run : runs)
        if (run.rows() >= kAbruptRun && run.first > 0 &&
            moves_within({column.rows[run.first], column.rows[run.last]}, speeds))
          add(ReflectionKind::kFrozen, {column.rows[run.first], column.rows[run.last]}, column.path,
              "another image in each snapshot");
    }
  }

 private:
  [[nodiscard]] Time time(size_t row) const { return time_from_ns(block_.times[row]); }

  void add(ReflectionKind kind, const EqualRun& run, const std::string& member,
           std::string expected) {
    findings_.add(
        {kind, Severity::kFault, block_.entity, member, time(run.first), time(run.last), run.rows(),
         fmt::format("the same value in {} snapshots", run.rows()), std::move(expected)},
        Duration(0));
  }

  /// Whether its snapshots do not come at the usual rate.
  [[nodiscard]] bool is_odd_time(const EqualRun& run) const {
    for (size_t i = run.first + 1; i <= run.last; ++i)
      if (1e-9 * static_cast<double>(block_.times[i] - block_.times[i - 1]) < 0.75 * block_.step_s)
        return true;
    return false;
  }

  /// Whether the speed changes at a row much more than around it.
  [[nodiscard]] static bool is_leap(const std::vector<double>& leaps, size_t row) {
    constexpr size_t kAround = 8;
    double around = 0;
    for (size_t i = row - std::min(row, kAround); i < std::min(leaps.size(), row + kAround); ++i)
      if (i + 2 <= row || i > row + 2) around = std::max(around, leaps[i]);
    return row < leaps.size() && leaps[row] > 0.3 && leaps[row] > kCopiedLeap * around;
  }

  /// Whether the numbers beside an image move while it stands still; where there are none, they
  /// may.
  [[nodiscard]] bool moves_within(const EqualRun& run, const std::vector<double>& speeds) const {
    if (block_.numbers.empty()) return true;
    double sum = 0;
    for (size_t i = run.first + 1; i <= run.last; ++i) sum += speeds[i];
    return sum > kCopiedMotion * static_cast<double>(run.rows() - 1);
  }

  [[nodiscard]] bool moves_around(const EqualRun& run, const std::vector<double>& speeds) const {
    const double after = run.last + 1 < block_.rows() ? speeds[run.last + 1] : 0;
    return std::min(speeds[run.first], after) > kCopiedMotion;
  }

  void add_copy(size_t original, size_t first, size_t last) {
    findings_.add(
        {ReflectionKind::kDuplicate, Severity::kFault, block_.entity, "", time(first), time(last),
         last - first + 1, fmt::format("what was at {} again", engram::to_string(time(original))),
         "another value"},
        Duration(0));
  }

  /// Values that were met before, one after the other: a piece that was recorded twice.
  void look_for_copies(const RelativeMotion& relative) {
    std::unordered_map<uint64_t, size_t> met;
    size_t first = 0, original = 0, count = 0;
    double motion = 0;
    for (size_t i = 0; i <= block_.rows(); ++i) {
      const auto known = i < block_.rows() ? met.find(block_.value_hashes[i]) : met.end();
      const bool is_copy = known != met.end() && known->second + 1 < i &&
                           block_.value_hashes[i] != block_.value_hashes[i - 1];
      if (count > 0 && (!is_copy || known->second != original + count)) {
        // At rest, noise returns to the same values now and then, and what moves to and fro comes
        // by again. A piece that was recorded twice does not fit to what lies around it.
        if (count >= kCopiedRun && motion > kCopiedMotion * static_cast<double>(count) &&
            (is_leap(relative.leaps, first) || is_leap(relative.leaps, i)))
          add_copy(original, first, first + count - 1);
        count = 0;
        motion = 0;
      }
      if (is_copy) {
        if (count == 0) {
          first = i;
          original = known->second;
        }
        ++count;
        motion += relative.speeds[i];
      }
      if (i < block_.rows()) met.insert_or_assign(block_.value_hashes[i], i);
    }
  }

  /// Whatever rests, slows down before and starts slowly. What stops and goes on at full speed did
  /// not rest.
  void look_for_abrupt_ends(const std::vector<EqualRun>& runs) {
    const RelativeMotion motion = relative_motion(block_);
    const std::vector<double>& speeds = motion.speeds;
    for (const EqualRun& run : runs) {
      if (run.rows() < kAbruptRun || run.first == 0 || run.last + 1 >= block_.rows()) continue;
      const double before = speeds[run.first], after = speeds[run.last + 1];
      if (std::min(before, after) < 0.35 || std::max(before, after) < 0.7) continue;
      add(ReflectionKind::kFrozen, run, "", "motion, as before and after");
    }
  }

  const SeriesBlock& block_;
  EntityReflection& entity_;
  FindingList& findings_;
};

}  // namespace

void look_at_frozen(const SeriesBlock& block, EntityReflection& entity, FindingList& findings) {
  FrozenLook look(block, entity, findings);
  look.look_at_events();
  if (!block.is_periodic) return;
  look.look_at_images();
  if (block.rows() >= kMinFrozenRows && !block.numbers.empty()) look.look_at_values();
}

}  // namespace engram::ltm
