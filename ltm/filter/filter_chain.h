// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/filter/linked_buffer.h"
#include "ltm/filter/registry.h"

namespace engram::ltm {

/// Counts what happened at one filter. At every moment: offered = kept + all dropped + held.
struct FilterCounters {
  std::string filter;  ///< Name of the filter.
  uint64_t offered = 0;
  uint64_t offered_bytes = 0;  ///< Plain bytes.
  uint64_t kept = 0;
  uint64_t dropped_bytes = 0;                               ///< Plain bytes.
  std::map<std::string, uint64_t, std::less<>> dropped_by;  ///< Per reason.
  HeldSnapshots held;                                       ///< Held at present.

  [[nodiscard]] uint64_t dropped() const;
};

/// The filters of one entity in sequence. Each filter sees what those before it keep.
///
/// A candidate whose time is not after the newest one is late (or changes an existing time): it
/// bypasses all filters. If ten late candidates in a row have increasing times, the clock was set
/// back: the filters release what they hold and start again from there.
///
/// With LinkedBuffer::Options what filters drop is held for a while, and kept after all if
/// something links to it. It then counts as kept by the filter that dropped it, and those behind
/// that did not see it. Threading: one thread.
class FilterChain {
 public:
  /// What leaves the chain in one step.
  struct Output {
    std::vector<Candidate> kept;
    uint64_t dropped = 0;
    uint64_t dropped_bytes = 0;  ///< Plain bytes.
  };

  /// Number of late candidates in a row, with increasing times, that mean a clock was set back.
  static constexpr int kLateOfNewClock = 10;

  /// Without filters it keeps everything.
  /// Errors: kInvalidArgument if options do not validate.
  static Result<FilterChain> create(std::vector<FilterOptions> filters,
                                    const std::optional<LinkedBuffer::Options>& linked = {});

  void offer(Candidate candidate, Output& output);
  /// Drops a candidate before it is made, if the first filter would drop it for its time alone. If
  /// it returns false, nothing happened: make the candidate and offer it.
  bool drop_at(Time time, uint64_t raw_bytes, Output& output);
  /// Filters decide on all that they hold. What they drop may be wanted yet.
  void flush(Output& output);
  /// Drops what is held in case that something links to it.
  void drop_unlinked(Output& output);
  /// Something links to the snapshot of this time: it is kept, now or when filters drop it.
  void want(Time time, Output& output);
  [[nodiscard]] bool keeps_linked() const { return linked_.has_value(); }
  /// Adds the times of what filters hold.
  void add_held_times(TimeSet& times) const;
  /// Drops what filters hold of these times. Filters that remember values start again, so that
  /// nothing is compared with one that was forgotten.
  void forget(const TimeSet& times, Output& output);
  void notice(const Snapshot& snapshot, const std::optional<idf::Type>& type, Output& output);
  [[nodiscard]] bool listens_to(const MemoryId& entity) const;

  [[nodiscard]] bool empty() const { return stages_.empty(); }
  [[nodiscard]] HeldSnapshots held() const;
  /// Number of late snapshots, which were kept without filtering.
  [[nodiscard]] uint64_t late() const { return late_; }
  /// One per filter, in the order of the chain.
  [[nodiscard]] std::vector<FilterCounters> counters() const;

 private:
  struct Stage {
    std::unique_ptr<Filter> filter;
    FilterCounters counters;
  };

  explicit FilterChain(std::vector<FilterOptions> options) : options_(std::move(options)) {}

  [[nodiscard]] bool is_late(Time time);
  void begin_anew(Output& output);
  void replace_filter(size_t stage);
  void pass(size_t stage, Candidate candidate, Output& output);
  void settle(size_t stage, FilterDecisions decisions, Output& output);
  void count_drop(size_t stage, std::string_view reason, uint64_t bytes, Output& output);
  void count_drops(std::vector<LinkedBuffer::Dropped> dropped, Output& output);
  void keep_linked(LinkedBuffer::Dropped dropped, Output& output);
  [[nodiscard]] FilterDecisions undecided() const;

  std::vector<FilterOptions> options_;
  std::vector<Stage> stages_;
  std::optional<LinkedBuffer> linked_;
  std::optional<Time> newest_;
  std::optional<Time> newest_late_;
  int late_run_ = 0;
  uint64_t late_ = 0;
};

}  // namespace engram::ltm
