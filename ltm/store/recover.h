// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>

#include "ltm/memory/memory_id.h"
#include "ltm/store/store_check.h"

namespace engram::ltm {

struct RecoverOptions {
  /// Leaves out what lies after this time, in every form. A snapshot from the far future, which a
  /// wrong clock made, is the latest of its entity for ever.
  std::optional<Time> latest;
  /// Tests a model file. If empty, a model whose checksum is unknown is copied without a test.
  ModelTest test_model;
};

/// Counts of saved and lost snapshots of one entity, for each form.
struct RecoveredEntity {
  uint64_t recorded = 0;  ///< Snapshots saved from segments.
  uint64_t recorded_lost = 0;
  uint64_t latent = 0;  ///< Snapshots whose latents were saved.
  uint64_t latent_lost = 0;
  /// Snapshots saved from journals. Lost frames cannot be attributed to an entity.
  uint64_t unsealed = 0;
  uint64_t too_late = 0;  ///< Snapshots that were left out: see RecoverOptions::latest.
};

struct RecoverReport {
  bool is_rebuilt = false;  ///< The manifest was damaged or missing and was rebuilt from the files.
  uint64_t segments_copied = 0;     ///< Undamaged segments, copied unchanged.
  uint64_t segments_rewritten = 0;  ///< Damaged segments, rewritten from their readable snapshots.
  uint64_t segments_lost = 0;
  uint64_t models = 0;
  uint64_t models_lost = 0;
  uint64_t journals = 0;
  uint64_t damaged_places = 0;  ///< Places in journals where acknowledged data was lost.
  std::map<MemoryId, RecoveredEntity> entities;
  /// A fault for each loss, and notes.
  std::vector<Finding> findings;

  [[nodiscard]] bool has_loss() const;
};

/// Copies everything readable in `source` into a new store. It never writes to `source`. The copy
/// is made as `target`.unfinished and gets the name `target` once it is complete.
///
/// Undamaged files are copied unchanged. Of a damaged segment, every snapshot that passes its
/// checksums is rewritten; of a damaged journal, every whole frame. If the manifest is damaged or
/// missing, it is rebuilt from the files. In that case segments are ordered by number, and the
/// number of snapshots in unreadable groups and files is unknown.
///
/// Errors: kNotFound if there is no store; kFailedPrecondition if its format is newer, if a process
/// writes to it, or if the decoder of a group of images is not installed; kAlreadyExists if
/// `target` or the unfinished copy of a killed recovery exists; kInvalidArgument if `target` lies
/// in `source`; kResourceExhausted, kUnavailable, kCancelled.
/// Source: docs/format.md, section "Checking and recovering".
Result<RecoverReport> recover_store(const std::filesystem::path& source,
                                    const std::filesystem::path& target,
                                    const RecoverOptions& options = {},
                                    const ProgressSink& progress = {},
                                    const std::stop_token& stop = {});

}  // namespace engram::ltm
