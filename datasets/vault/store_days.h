// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "datasets/vault/vault_folder.h"
#include "ltm/memory/query.h"
#include "ltm/recall/recall.h"

namespace engram::datasets::vault {

/// What a store has of one entity and day.
struct StoreDay {
  ltm::MemoryId entity;
  Day day = 0;
  uint64_t snapshots = 0;
  /// Made of the places where the store has these snapshots: another one if any of them changed.
  /// Compaction changes it too.
  uint64_t source = 0;
  /// Made of their times, and of the redactions that replaced originals of this day.
  uint64_t times = 0;
  uint64_t latents_only = 0;  ///< Snapshots whose recorded form is gone.
};

/// True if a query selects all snapshots of an entity.
[[nodiscard]] bool selects_all(const ltm::Query& query, const ltm::MemoryId& entity);

/// Lists the days of which a query selects any snapshot, whole, in the order of entities and time.
/// Values are not read. Memory: per day.
/// Errors: those of exported_entities, read_redacted_days and Timeline; kCancelled after a stop.
Result<std::vector<StoreDay>> days_of_store(ltm::Recall& recall, const ltm::Query& query,
                                            ltm::Prefer prefer, const std::stop_token& stop);

}  // namespace engram::datasets::vault
