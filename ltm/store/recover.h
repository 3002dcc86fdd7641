// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "ltm/memory/memory_id.h"
#include "ltm/store/store_check.h"

namespace engram::ltm {

struct RecoverOptions {
  /// Empty: where its checksum is not known, a model file is taken as it is.
  ModelTest test_model;
};

/// What of one entity was saved and lost, form by form.
struct RecoveredEntity {
  uint64_t recorded = 0;  ///< Snapshots saved from segments.
  uint64_t recorded_lost = 0;
  uint64_t latent = 0;  ///< Snapshots whose latents were saved.
  uint64_t latent_lost = 0;
  uint64_t unsealed = 0;  ///< Snapshots saved from journals; what those lost has no name.
};

struct RecoverReport {
  bool is_rebuilt = false;          ///< The manifest was broken or gone: made anew from the files.
  uint64_t segments_copied = 0;     ///< Whole, as they were.
  uint64_t segments_rewritten = 0;  ///< From what is whole in them.
  uint64_t segments_lost = 0;
  uint64_t models = 0;
  uint64_t models_lost = 0;
  uint64_t journals = 0;
  uint64_t damaged_places = 0;  ///< In journals; acknowledged data was there.
  std::map<MemoryId, RecoveredEntity> entities;
  /// What was lost, each a fault, and what else is worth knowing.
  std::vector<Finding> findings;

  [[nodiscard]] bool has_loss() const;
};

/// Copies everything that can be read of `source` into a new store. Nothing is ever written to
/// `source`; `target` is there only once it is whole: until then it is `target`.unfinished.
///
/// Whole files are copied as they are. Of damaged segments every snapshot that passes its checksums
/// is written anew, of journals every whole frame. Where the manifest is broken or gone, the files
/// say what they hold; then segments count in the order of their numbers, and how many snapshots
/// unreadable groups and files held is not known.
///
/// Errors: kNotFound where there is no store; kFailedPrecondition where its format is newer, a
/// process writes to it or the decoder of a group of images is not installed; kAlreadyExists where
/// `target` or what a killed recover left is there; kInvalidArgument where `target` lies in
/// `source`; kResourceExhausted, kUnavailable, kCancelled.
/// Source: docs/format.md, section "Checking and recovering".
Result<RecoverReport> recover_store(const std::filesystem::path& source,
                                    const std::filesystem::path& target,
                                    const RecoverOptions& options = {},
                                    const ProgressSink& progress = {},
                                    const std::stop_token& stop = {});

}  // namespace engram::ltm
