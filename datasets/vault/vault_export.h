// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "datasets/vault/vault_folder.h"
#include "ltm/core/progress.h"
#include "ltm/memory/query.h"
#include "ltm/recall/recall.h"

namespace engram::datasets::vault {

struct VaultExportOptions {
  ltm::Recall::Options recall;
  /// Whether a vault that is a copy of another store takes this one's days as well.
  bool takes_other_store = false;
  /// Only count what would be written.
  bool is_dry = false;
};

/// A day that is not as it should be, and why.
struct VaultFinding {
  ltm::MemoryId entity;  ///< Empty if it is known only by its file.
  Day day = 0;
  std::string file;
  std::string what;
};

struct VaultExportReport {
  uint64_t added = 0;      ///< Days that the vault did not have.
  uint64_t replaced = 0;   ///< Days that changed: they have a new file and key.
  uint64_t unchanged = 0;  ///< Days that were as the vault has them.
  /// Of them, days that the vault has as they were recorded, and the store in part as latents only.
  uint64_t kept_recorded = 0;
  uint64_t destroyed = 0;  ///< Days that are not exported, as their keys were destroyed.
  /// Days that the vault alone has: the store forgot them, and the query selects all of its entity.
  uint64_t vault_alone = 0;
  uint64_t snapshots = 0;  ///< Of the days that were written; of a dry run those to be written.
  uint64_t instances = 0;
  uint64_t reconstructed = 0;        ///< Snapshots that were decoded from latents.
  uint64_t bytes = 0;                ///< Of the files that were written.
  std::vector<VaultFinding> unread;  ///< Days that the store could not read; they are left out.
};

/// Encrypts what a store has into a vault: each day of which the query selects anything, whole.
/// Days that the vault has already are left as they are, also if the store has no more than latents
/// of what was recorded. After a stop, what was committed by then stays, and the next export goes
/// on.
///
/// Memory: bounded, whatever the size of a day. Threading: one thread; `progress` is called from
/// it. Errors: those of VaultFolder and days_of_store; kFailedPrecondition if the vault is a copy
/// of another store; kCancelled after a stop; kResourceExhausted if the disk is full.
/// Source: docs/vault.md.
Result<VaultExportReport> export_to_vault(ltm::Recall& recall, const ltm::Query& query,
                                          const VaultPlaces& places,
                                          const VaultExportOptions& options,
                                          const ProgressSink& progress,
                                          const std::stop_token& stop);

}  // namespace engram::datasets::vault
