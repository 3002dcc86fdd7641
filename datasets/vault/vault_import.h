// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <vector>

#include "datasets/vault/vault_export.h"

namespace engram::datasets::vault {

struct VaultImportReport {
  uint64_t days = 0;       ///< Entity-days that came in, or were there.
  uint64_t snapshots = 0;  ///< Snapshots that came in.
  uint64_t instances = 0;
  uint64_t reconstructed = 0;  ///< Of them, those whose recorded form the vault never had.
  uint64_t already_there = 0;  ///< Snapshots at times at which the store has one: it stays.
  uint64_t destroyed = 0;      ///< Entity-days whose keys were destroyed.
  std::optional<Time> first;
  std::optional<Time> last;
  std::vector<VaultFinding> damaged;  ///< What could not be read; what came before it came in.
  bool is_cancelled = false;          ///< Stopped on request; the next import goes on.
};

/// Brings what a vault holds back into a store, which is made where there is none. Recorded values
/// come in as they were packed. Types are declared where the store has none.
///
/// Memory: bounded. Threading: one thread; `progress` is called from it.
/// Errors: those of read_keys_of and StoreWriter; kFailedPrecondition if a segment of the store has
/// another type; kResourceExhausted if the disk is nearly full. What came in by then stays.
Result<VaultImportReport> import_from_vault(const VaultPlaces& places,
                                            const std::filesystem::path& store,
                                            const ProgressSink& progress,
                                            const std::stop_token& stop);

}  // namespace engram::datasets::vault
