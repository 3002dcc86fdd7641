// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"
#include "training/fit/job_pace.h"
#include "training/forms/block_choice.h"
#include "training/night/encoding_limits.h"
#include "training/night/kept_quality.h"
#include "training/quality/quality_metrics.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Encodes recorded snapshots of an entity as blocks of latents, and compares the decoded values,
/// as a query will see them, with the recorded ones.
///
/// Threading: one thread.
class EntityEncoding {
 public:
  /// All arguments must outlive this object. `version` is that of the model. `times` counts the
  /// time of the work.
  EntityEncoding(ltm::StoreReader& reader, const ltm::MemoryId& entity, int version,
                 encoders::DeepModel& model, ltm::Encoder& decoder,
                 const RepresentationOptions& options, StageTimes& times)
      : reader_(reader),
        entity_(entity),
        version_(version),
        model_(model),
        max_rows_(model.block_rows()),
        choice_(model, options, &times),
        decoder_(decoder),
        times_(times) {}

  /// Encodes and compares `entries`, or as many of the first of them as the limits allow. Blocks
  /// never cross a gap between recordings. It waits between chains while the robot is busy.
  /// Errors: kCancelled; the errors of the store, of the model and of publishing.
  Status run(std::span<const ltm::SnapshotEntry> entries, JobPace& pace,
             const EncodingLimits& limits);

  /// Number of snapshots that were encoded.
  [[nodiscard]] size_t done() const { return done_; }
  /// Those of them that were not published.
  [[nodiscard]] std::vector<ltm::LatentSnapshot>& latents() { return latents_; }

  [[nodiscard]] KeptQuality quality() const;
  [[nodiscard]] BlockChoice& choice() { return choice_; }

 private:
  struct Run;
  using Parts = std::deque<std::span<const ltm::SnapshotEntry>>;

  /// Cuts at gaps between recordings, and into parts of at most one block of single instances.
  [[nodiscard]] Parts parts_of(std::span<const ltm::SnapshotEntry> entries) const;
  /// Takes the next parts of at most so many snapshots, whose videos are found together.
  Result<std::vector<Run>> read_next(Parts& parts, size_t max_snapshots);
  Result<Run> read(std::span<const ltm::SnapshotEntry> entries);
  /// Encodes runs, whose videos are found together.
  Status encode(std::span<const Run> runs, const std::stop_token& stop,
                const BlockChoice::Pause& pause);
  /// Decodes what was encoded of a run, and keeps it with its errors.
  Status keep(const Run& run, std::vector<ltm::Latent> latents);
  void count(const ltm::Latent& latent, const ltm::MeasuredError& error);

  ltm::StoreReader& reader_;
  const ltm::MemoryId& entity_;
  int version_;
  const encoders::DeepModel& model_;
  size_t max_rows_;
  BlockChoice choice_;
  ltm::Encoder& decoder_;
  StageTimes& times_;
  size_t done_ = 0;
  std::vector<ltm::LatentSnapshot> latents_;
  PsnrStatistics psnr_;
  RmseStatistics rmse_;
  uint64_t raw_bytes_ = 0;
  uint64_t latent_bytes_ = 0;
};

}  // namespace engram::training
