// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/time_set.h"
#include "ltm/store/latent.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// What rewriting segments did.
struct RewriteReport {
  uint64_t segments_before = 0;  ///< That were rewritten.
  uint64_t segments_after = 0;
  uint64_t bytes_before = 0;
  uint64_t bytes_after = 0;
  uint64_t snapshots = 0;  ///< Different moments that went.
  bool is_cancelled = false;

  [[nodiscard]] uint64_t freed_bytes() const {
    return bytes_before - std::min(bytes_before, bytes_after);
  }
};

struct CompactOptions {
  /// Segments grow up to about this size. Costs a few times as much memory.
  uint64_t segment_bytes = uint64_t{128} << 20;
  /// And up to so many snapshots: small ones cost more memory than their bytes.
  uint64_t segment_snapshots = 300'000;

  [[nodiscard]] Status validate() const;
};

struct DropReport {
  uint64_t snapshots = 0;
  uint64_t freed_bytes = 0;
  uint64_t kept = 0;  ///< Sealed snapshots whose recorded form stays.
};

/// Drops the recorded form of every sealed snapshot of `entity` that has latents and is not among
/// `keep`. The model files are checked and the latents read first.
/// Errors: kNotFound, kDataLoss, kUnavailable, kResourceExhausted.
Result<DropReport> drop_recorded(const std::filesystem::path& store, const MemoryId& entity,
                                 const TimeSet& keep);

/// Moments that are to be forgotten.
using ForgetSet = std::map<MemoryId, TimeSet>;

/// Joins small recorded segments that follow each other, and leaves out what updates replaced.
/// Each step publishes whole files: killed at any moment, nothing is lost.
/// Errors: kDataLoss where a segment is damaged (nothing of it is changed); kUnavailable,
/// kResourceExhausted.
/// Threading: runs beside a live writer and beside readers, which may have to open the store again.
Result<RewriteReport> compact(const std::filesystem::path& store, const CompactOptions& options,
                              const ProgressSink& progress = {}, const std::stop_token& stop = {});

struct ForgetRewriteOptions {
  /// Where it is given, each block of latents that lacks rows in a segment that is written anew is
  /// coded again from those that stay. Else its bytes stay whole until its last row goes: nothing
  /// reads the rows that went, but they could still be decoded from the file.
  LatentRecoder recode_latents = {};
};

/// Takes sealed snapshots out of the store in every form, recorded and latent, and counts them in
/// the manifest. What is in a journal stays. A model that no latent names any more goes.
/// Errors: those of compact and of the recoder; then nothing of that segment is changed.
/// Threading: as of compact.
Result<RewriteReport> forget_snapshots(const std::filesystem::path& store, const ForgetSet& gone,
                                       const ProgressSink& progress = {},
                                       const std::stop_token& stop = {},
                                       const ForgetRewriteOptions& options = {});

}  // namespace engram::ltm
