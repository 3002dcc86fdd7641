// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/store/store_reader.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Reports what a store holds of an entity. `rate_hz` is the number of snapshots per second within
/// recordings.
[[nodiscard]] Json stored_entity_json(const ltm::EntitySummary& summary,
                                      const ltm::StoredForms& forms, double rate_hz);
void print_stored_entity(const ltm::EntitySummary& summary, const ltm::StoredForms& forms,
                         double rate_hz);

/// Sums over the entities of a provider segment, for stores of more entities than people read.
struct StoredSegment {
  uint64_t entities = 0;
  uint64_t snapshots = 0;
  Time first{};
  Time last{};
  uint64_t raw_bytes = 0;
  uint64_t stored_bytes = 0;  ///< Recorded forms and latents.

  void add(const ltm::EntitySummary& summary);
};
void print_stored_segment(const ltm::MemoryId& segment, const StoredSegment& sums);

/// The types of segments: {"Vision/RGB": "object ..."}.
[[nodiscard]] Json types_json(const ltm::SegmentTypes& types);
void print_types(const ltm::SegmentTypes& types);

}  // namespace engram::reports
