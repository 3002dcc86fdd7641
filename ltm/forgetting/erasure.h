// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/forget_plan.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Where a store has its reports of erasures.
inline constexpr const char* kErasureFolder = "erasures";

/// What was done to what stays of one entity, so that nothing of what was erased is left in it.
struct EntityErasure {
  uint64_t erased = 0;
  /// Staying snapshots without a recorded form, whose latents were coded anew.
  uint64_t recoded = 0;
  /// Staying snapshots whose latents were removed; the next night makes new ones of the recorded
  /// form.
  uint64_t uncoded = 0;
  /// Staying snapshots whose latents were copied for a model without what went.
  uint64_t copied = 0;
  /// PSNR of the worst image that was coded anew: as expected, and what it certainly has. Unit: dB.
  double expected_db = std::numeric_limits<double>::infinity();
  double certain_db = std::numeric_limits<double>::infinity();
  /// Models that had learned from what went, or kept pictures of it, and are gone: "v2".
  std::vector<std::string> models;
  /// UTC days of which a redaction replaced originals (redacted_days.h).
  std::set<std::string> redacted_days;
  /// Whether the entity waits for the next night to learn again.
  bool is_waiting = false;
};

/// By entity.
using Erasures = std::map<MemoryId, EntityErasure>;

/// Codes anew what stays and was coded together with `gone`, and replaces models that learned from
/// it, before the snapshots go. With an empty set it looks for what earlier forgetting left, in all
/// entities. A stop ends it between two groups with kCancelled; nothing that was to stay is lost
/// then. Forgetting gets it from above, because it needs codecs and models.
using CodeAnew =
    std::function<Result<Erasures>(const std::filesystem::path& store, const ForgetSet& gone,
                                   const ProgressSink& progress, const std::stop_token& stop)>;

/// What an erasure did, without the content.
struct ErasureReport {
  Erasures entities;
  std::vector<std::string> files;  ///< Removed side files, relative to the store.
  std::string report;              ///< The file of this report, relative to the store.

  /// Adds what a later round did.
  void add(const Erasures& later);

  /// As it is kept and told. PSNRs are null where no image was coded anew.
  [[nodiscard]] nlohmann::ordered_json to_json() const;
};

/// Seals what is in the journals, because only sealed snapshots can be erased.
/// Errors: kFailedPrecondition if the store is being recorded into; those of sealing.
Status seal_before_erasing(const std::filesystem::path& store);

/// Whether any instance of a snapshot was made of one of a snapshot that goes.
[[nodiscard]] bool is_made_of(const Snapshot& snapshot, const ForgetSet& gone);

/// Adds to a plan the augmented snapshots that were made of what goes, and those made of these.
/// Errors: those of reading.
Status add_made_of(StoreReader& reader, ForgetPlan& plan);

/// Adds to a plan that does not erase a note on what of it can still be decoded afterwards, and for
/// how long.
/// Errors: those of reading.
Status note_what_is_left(StoreReader& reader, ForgetPlan& plan);

/// Removes the side files that may hold what was erased: checkpoints of trainings of these
/// entities, damaged journals that were kept, and what killed processes left. Returns their names.
/// Errors: those of find_orphans; kUnavailable.
Result<std::vector<std::string>> remove_side_files(const std::filesystem::path& store,
                                                   const Erasures& erased);

/// Writes the report into the folder `erasures/` of the store, and puts the name of its file into
/// it.
/// Errors: kUnavailable, kResourceExhausted.
Status write_erasure_report(const std::filesystem::path& store, Time when, ErasureReport& report);

}  // namespace engram::ltm
