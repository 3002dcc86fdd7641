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

/// The result of rewriting segments.
struct RewriteReport {
  uint64_t segments_before = 0;  ///< Number of segments that were rewritten.
  uint64_t segments_after = 0;
  uint64_t bytes_before = 0;
  uint64_t bytes_after = 0;
  uint64_t snapshots = 0;  ///< Number of distinct times that were removed.
  bool is_cancelled = false;

  [[nodiscard]] uint64_t freed_bytes() const {
    return bytes_before - std::min(bytes_before, bytes_after);
  }
};

struct CompactOptions {
  /// Approximate max size of a joined segment, in bytes. Joining needs a few times as much memory.
  /// Lower it on machines with little memory.
  uint64_t segment_bytes = uint64_t{128} << 20;
  /// Max number of snapshots of a joined segment. Small snapshots need more memory than their
  /// stored bytes, so `segment_bytes` alone would not bound it.
  uint64_t segment_snapshots = 300'000;

  [[nodiscard]] Status validate() const;
};

struct DropReport {
  uint64_t snapshots = 0;
  uint64_t freed_bytes = 0;
  uint64_t kept = 0;  ///< Number of sealed snapshots whose recorded form is kept.
};

/// Drops the recorded form of every sealed snapshot of `entity` that has latents and is not in
/// `keep`. It first checks the model files and reads the latents, because the recorded form may be
/// the only good copy.
/// Errors: kNotFound, kDataLoss, kUnavailable, kResourceExhausted.
Result<DropReport> drop_recorded(const std::filesystem::path& store, const MemoryId& entity,
                                 const TimeSet& keep);

/// Times to forget, by entity.
using ForgetSet = std::map<MemoryId, TimeSet>;

/// Joins small consecutive recorded segments and leaves out snapshots that updates replaced. Each
/// step publishes whole files, so a kill at any moment loses nothing.
/// Errors: kDataLoss if a segment is damaged (that segment stays unchanged); kUnavailable,
/// kResourceExhausted.
/// Threading: may run beside a live writer and beside readers. Readers may have to open the store
/// again.
Result<RewriteReport> compact(const std::filesystem::path& store, const CompactOptions& options,
                              const ProgressSink& progress = {}, const std::stop_token& stop = {});

/// Removes sealed snapshots from the store in every form, recorded and latent, and counts them in
/// the manifest. Snapshots in journals are not removed. Models that no latent uses any more are
/// removed. A block of latents that keeps some of its rows keeps its bytes, from which the others
/// could still be decoded: see remove_latents().
/// Errors: those of compact; the segment at hand is then unchanged.
/// Threading: like compact.
Result<RewriteReport> forget_snapshots(const std::filesystem::path& store, const ForgetSet& gone,
                                       const ProgressSink& progress = {},
                                       const std::stop_token& stop = {});

}  // namespace engram::ltm
