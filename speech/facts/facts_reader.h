// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: which segments of a memory tell of what, and the index of what is rare.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "memory/memory.h"
#include "speech/facts/fact_kinds.h"
#include "speech/facts/read_records.h"

namespace engram::speech {

/// Threading: one thread.
class FactsReader {
 public:
  explicit FactsReader(Memory& memory) : memory_(memory) {}

  Status refresh();

  /// The snapshots that a selector selects of an entity or of all entities below a segment. An
  /// entity that is not there has none.
  Result<ltm::QueryResult> query(const ltm::MemoryId& prefix, const ltm::Selector& selector);

  Memory& memory_;
  Time first_{};
  Time last_{};
  KnownWorld world_;
  ExecutionTable execution_table_;
  std::vector<Execution> executions_;
  std::vector<SpokenWords> words_;
  std::vector<TaskPlan> plans_;
  std::vector<RefusedRequest> refusals_;
  std::vector<DriveNote> drives_;
  std::vector<std::string> skills_;
  std::vector<ltm::MemoryId> thing_segments_;
  std::vector<ltm::MemoryId> robots_;

 private:
  /// Up to when an entity was read, and up to when there is something to read.
  struct Extent {
    Time read_until = Time::min();
    Time last = Time::min();
  };
  /// A provider segment: what it tells of, and its entities.
  struct Segment {
    FactKind kind = FactKind::kNothing;
    std::map<ltm::MemoryId, Extent> entities{};
    bool is_read = false;
  };

  Status find_segments();
  Status look_at(const ltm::MemoryId& segment, const ltm::MemoryId& entity, Segment& found);
  Status read_world();
  Status read_classes(std::map<ltm::MemoryId, KnownThing>& classes);
  Status read_things(const std::map<ltm::MemoryId, KnownThing>& classes);
  Status read_places();
  Status read_segment(const ltm::MemoryId& id, Segment& segment);
  Status read_below(const ltm::MemoryId& prefix, Time from, Time to, FactKind kind);
  void take(FactKind kind, const ltm::MemoryId& id, const idf::Data& value);
  void collect();

  std::map<ltm::MemoryId, Segment> segments_;
  bool is_world_read_ = false;
  bool is_collected_ = false;  ///< The lists have what was taken.
};

}  // namespace engram::speech
