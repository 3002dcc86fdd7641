// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/core/time_set.h"
#include "ltm/idf/type.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// A snapshot on its way through filters. Copies share its arrays.
struct Candidate {
  Snapshot snapshot;
  uint64_t raw_bytes = 0;         ///< Snapshot::raw_bytes, computed once.
  uint64_t commit = 0;            ///< Number of the commit that it came with.
  std::optional<idf::Type> type;  ///< The type of its segment, if one is declared.
};

/// The decisions of a filter in one step: the candidates that it keeps and those that it drops.
struct FilterDecisions {
  struct Drop {
    std::string_view reason;                  ///< Lives as long as the program.
    uint64_t bytes = 0;                       ///< Plain bytes.
    std::optional<Candidate> candidate = {};  ///< With `has_dropped`, if it was made.
  };

  std::vector<Candidate> kept;  ///< In the order in which they were offered.
  std::vector<Drop> dropped;
  bool has_dropped = false;  ///< What is dropped is handed on, too.

  void keep(Candidate candidate) { kept.push_back(std::move(candidate)); }
  void drop(std::string_view reason, const Candidate& candidate) {
    drop(reason, candidate.raw_bytes);
    if (has_dropped) dropped.back().candidate = candidate;
  }
  void drop(std::string_view reason, uint64_t bytes) { dropped.push_back({reason, bytes}); }
};

/// Snapshots that a filter has not decided on yet.
struct HeldSnapshots {
  uint64_t snapshots = 0;
  uint64_t bytes = 0;  ///< Plain bytes.
};

/// Decides which snapshots of one entity are worth keeping.
///
/// Each candidate is kept or dropped exactly once: at once, or after it was held until a later
/// candidate or a flush decided. Held candidates are in memory only and are lost if the process
/// ends.
/// Time: increases strictly; FilterChain ensures it.
/// Threading: one thread; each entity owns its own filters.
/// Complexity: O(size of one snapshot) per call, spread over all calls.
class Filter {
 public:
  virtual ~Filter() = default;

  /// Its name in counters: "frequency", ...
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Takes one candidate, and may decide on it or on others that are held.
  virtual void offer(Candidate candidate, FilterDecisions& decisions) = 0;

  /// The reason for which it would drop a candidate of this time with any value; nothing if it
  /// would not or if the value matters. Changes nothing.
  [[nodiscard]] virtual std::optional<std::string_view> drops_at(Time) const { return {}; }

  /// Decides on all held candidates, because no more will come.
  virtual void flush(FilterDecisions&) {}

  [[nodiscard]] virtual HeldSnapshots held() const { return {}; }

  /// Adds the times of what it holds.
  virtual void add_held_times(TimeSet&) const {}

  /// Drops what it holds of these times, as kForgotten. Returns false if it may remember more of
  /// what it saw, such as a value that it compares with: then a new filter has to take its place.
  virtual bool forget(const TimeSet&, FilterDecisions&) { return false; }
  static constexpr std::string_view kForgotten = "forgotten";

  /// True if notice() must be called for this entity, which is not the filter's own.
  [[nodiscard]] virtual bool listens_to(const MemoryId&) const { return false; }

  /// Tells the filter of a new snapshot of another entity, which may decide on held candidates,
  /// with the type of its values, if it is known.
  virtual void notice(const Snapshot&, const std::optional<idf::Type>&, FilterDecisions&) {}
};

}  // namespace engram::ltm
