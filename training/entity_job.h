// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/temporary_file.h"
#include "training/consolidate.h"

// Private to this room.

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// Offline work on one entity of one generation of a store.
class EntityJob {
 public:
  /// All but the entity outlive it.
  EntityJob(ltm::StoreReader& reader, ltm::MemoryId entity, const ConsolidateOptions& options,
            const ProgressSink& progress, const std::stop_token& stop);

  /// Finds the recorded snapshots, or the reason to skip the entity.
  Status plan();

  /// How much of the training time this entity should get, beside others. Larger values need more
  /// of it, but not in proportion.
  [[nodiscard]] double weight() const;

  /// Trains for `budget` where the entity is not skipped.
  Result<EntityReport> run(Duration budget);

 private:
  Status skip(std::string reason);
  Status train_and_publish(Duration budget);
  Status train(const TrainOptions& train, const std::filesystem::path& file);
  Result<std::shared_ptr<encoders::DeepModel>> newest_model();
  Result<std::shared_ptr<encoders::DeepModel>> model_for(const TrainOptions& options);
  /// Trains a model and codes all snapshots with it. False where it has to be skipped.
  Result<bool> make(const TrainOptions& train, const RepresentationOptions& representation);
  /// Whether networks for images could save five times their bytes, if they took none at all.
  Result<bool> wants_networks(const TrainOptions& train);
  [[nodiscard]] bool video_is_cheaper();
  /// Bytes of a snapshot's images as video at the bound, from some evenly spaced runs.
  Result<double> sampled_video_bytes();
  /// Adds the images of a snapshot's first instance, one per image member.
  Status append_images(const ltm::SnapshotEntry& entry,
                       std::vector<std::vector<idf::NdArray>>& images);

  ltm::StoreReader& reader_;
  ltm::MemoryId entity_;
  const ConsolidateOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  idf::Layout layout_;
  double plain_bytes_ = 0;
  std::vector<ltm::SnapshotEntry> entries_;
  std::vector<ltm::LatentSnapshot> latents_;
  std::optional<ltm::TemporaryFile> file_;  ///< The model that will be published.
  EntityReport report_;
};

}  // namespace engram::training
