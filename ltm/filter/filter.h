// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// A snapshot on its way through filters. Copying shares arrays.
struct Candidate {
  Snapshot snapshot;
  uint64_t raw_bytes = 0;         ///< Snapshot::raw_bytes, counted once.
  uint64_t commit = 0;            ///< Number of the commit that it came with.
  std::optional<idf::Type> type;  ///< Of its segment, where there is one.
};

/// What a filter decided in one step: candidates that leave it, and those that end there.
struct FilterDecisions {
  struct Drop {
    std::string_view reason;  ///< Lives as long as the program.
    uint64_t bytes = 0;       ///< Plain.
  };

  std::vector<Candidate> kept;  ///< In the order in which they were offered.
  std::vector<Drop> dropped;

  void keep(Candidate candidate) { kept.push_back(std::move(candidate)); }
  void drop(std::string_view reason, const Candidate& candidate) {
    drop(reason, candidate.raw_bytes);
  }
  void drop(std::string_view reason, uint64_t bytes) { dropped.push_back({reason, bytes}); }
};

/// Snapshots that a filter has not decided on yet.
struct HeldSnapshots {
  uint64_t snapshots = 0;
  uint64_t bytes = 0;  ///< Plain.
};

/// Says which snapshots of one entity are worth keeping.
///
/// Each candidate is kept or dropped once: right away, or after it was held until later ones or a
/// flush decided. What is held is in memory only and is lost where the process ends.
/// Time: increases strictly; FilterChain sees to it.
/// Threading: one thread; each entity owns its own filters.
/// Complexity: O(size of one snapshot) per call, spread over all calls.
class Filter {
 public:
  virtual ~Filter() = default;

  /// "frequency", ...: under which counters name it.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Takes one candidate, and decides on it or on others that are held.
  virtual void offer(Candidate candidate, FilterDecisions& decisions) = 0;

  /// Why it would drop a candidate of this time whatever its value is; nothing where it would not,
  /// or cannot tell. Changes nothing.
  [[nodiscard]] virtual std::optional<std::string_view> drops_at(Time) const { return {}; }

  /// Decides on all that is held: nothing more will come.
  virtual void flush(FilterDecisions&) {}

  [[nodiscard]] virtual HeldSnapshots held() const { return {}; }

  /// True where `notice` wants to know of this entity, which is not the filter's own.
  [[nodiscard]] virtual bool listens_to(const MemoryId&) const { return false; }

  /// Another entity has a new snapshot, which may decide on what is held.
  virtual void notice(const Snapshot&, FilterDecisions&) {}
};

}  // namespace engram::ltm
