// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/filter/registry.h"

namespace engram::ltm {

/// What happened at one filter: offered = kept + all dropped + held, at every moment.
struct FilterCounters {
  std::string filter;  ///< Its name.
  uint64_t offered = 0;
  uint64_t offered_bytes = 0;  ///< Plain.
  uint64_t kept = 0;
  uint64_t dropped_bytes = 0;                               ///< Plain.
  std::map<std::string, uint64_t, std::less<>> dropped_by;  ///< Per reason.
  HeldSnapshots held;                                       ///< Now.

  [[nodiscard]] uint64_t dropped() const;
};

/// The filters of one entity, one behind the other: each sees what those before it keep.
///
/// A candidate that does not come after the newest one is late (or changes an existing time): it
/// passes all filters untouched. Where ten late ones in a row follow each other in time, the clock
/// was set back: the filters let go of what they hold and begin anew from there.
/// Threading: one thread.
class FilterChain {
 public:
  /// What leaves the chain in one step.
  struct Output {
    std::vector<Candidate> kept;
    uint64_t dropped = 0;
    uint64_t dropped_bytes = 0;  ///< Plain.
  };

  /// Late candidates in a row, each after the one before, that mean a clock that was set back.
  static constexpr int kLateOfNewClock = 10;

  /// Without filters it keeps all.
  /// Errors: kInvalidArgument where options do not validate.
  static Result<FilterChain> create(std::vector<FilterOptions> filters);

  void offer(Candidate candidate, Output& output);
  /// Drops a candidate that is not made yet, where the first filter needs its time alone for that.
  /// False: nothing happened; make it and offer it.
  bool drop_at(Time time, uint64_t raw_bytes, Output& output);
  void flush(Output& output);
  void notice(const Snapshot& snapshot, Output& output);
  [[nodiscard]] bool listens_to(const MemoryId& entity) const;

  [[nodiscard]] bool empty() const { return stages_.empty(); }
  [[nodiscard]] HeldSnapshots held() const;
  /// Snapshots that came too late to be filtered, and were kept.
  [[nodiscard]] uint64_t late() const { return late_; }
  /// In the order of the chain.
  [[nodiscard]] std::vector<FilterCounters> counters() const;

 private:
  struct Stage {
    std::unique_ptr<Filter> filter;
    FilterCounters counters;
  };

  explicit FilterChain(std::vector<FilterOptions> options) : options_(std::move(options)) {}

  [[nodiscard]] bool is_late(Time time);
  void begin_anew(Output& output);
  void pass(size_t stage, Candidate candidate, Output& output);
  void settle(size_t stage, FilterDecisions decisions, Output& output);

  std::vector<FilterOptions> options_;
  std::vector<Stage> stages_;
  std::optional<Time> newest_;
  std::optional<Time> newest_late_;
  int late_run_ = 0;
  uint64_t late_ = 0;
};

}  // namespace engram::ltm
