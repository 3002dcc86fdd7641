// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/erasure.h"
#include "ltm/recall/model.h"
#include "ltm/redaction/redactor.h"

namespace engram::ltm {

/// What to redact in a store, and with what.
struct StoreRedactionJob {
  std::filesystem::path store;
  /// IDs and queries, as in find_forget_targets; empty: all snapshots.
  std::vector<std::string> targets;
  RedactionOptions options;
  bool is_dry_run = false;  ///< Only look.
  /// Redacted snapshots that are appended together, and noted on the disk before. Unit: plain
  /// bytes.
  uint64_t max_appended_bytes = uint64_t{32} << 20;
  /// Opens models of what is kept as latents alone.
  ModelLoader loader;
  /// Codes anew what was coded together with what goes, and replaces models that learned from it.
  CodeAnew code_anew;
  ProgressSink progress;
  std::stop_token stop;
};

/// What was done to one entity, by this run and by earlier ones that were killed and that it
/// finished. Unit: snapshots, unless named.
struct EntityRedaction {
  uint64_t looked_at = 0;  ///< By this run.
  uint64_t redacted = 0;   ///< Recorded anew, redacted.
  uint64_t boxes = 0;      ///< Boxes.
  uint64_t dropped = 0;    ///< Forgotten, because that is the action.
  /// They stay as they are, since the detector gave no answer, or they have images in a form in
  /// which no detector looks.
  uint64_t unanswered = 0;
  uint64_t unreadable = 0;
};

/// What a redaction of a store did.
struct StoreRedaction {
  std::map<MemoryId, EntityRedaction> entities;  ///< Those that were looked at or finished.
  /// Snapshots among these that an earlier run redacted or meant to forget before it was killed, of
  /// which this one took the originals.
  uint64_t taken_up = 0;
  uint64_t made_of = 0;  ///< Augmented snapshots that were made of redacted ones, and went.
  std::optional<ErasureReport> erased;  ///< If anything was to go.
  /// Of the store's directory, before the first run of those that this one finished.
  uint64_t bytes_before = 0;
  uint64_t bytes_after = 0;

  [[nodiscard]] EntityRedaction total() const;
  [[nodiscard]] nlohmann::ordered_json to_json() const;
};

/// Redacts what a store has already: looks at each snapshot in the order of time, decodes it where
/// only latents are left, records it anew with what was found taken out, and then erases the
/// originals in every form, as `engram forget --erase` does. Times, metadata and all other parts of
/// the values stay.
///
/// A kill at any moment leaves every snapshot in its old or its new form. Which originals are still
/// to go, and which boxes still hold, stands in a file of the store, and the same call takes them
/// up. Errors: those of Redactor::create, find_forget_targets, reading and writing;
/// kFailedPrecondition if another process writes to the store, learns from it or erases from it;
/// kCancelled on a stop: then the same call goes on.
/// Threading: one job at a time for a store.
/// Source: docs/forgetting.md, section "Redacting".
Result<StoreRedaction> redact_store(const StoreRedactionJob& job);

/// The number of redacted snapshots whose originals may still be in the store, because a redaction
/// was cut off.
/// Errors: kDataLoss if the file that tells is damaged; kUnavailable.
Result<uint64_t> pending_redactions(const std::filesystem::path& store);

}  // namespace engram::ltm
