// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/temporary_file.h"
#include "training/fit/job_pace.h"
#include "training/fit/train_control.h"
#include "training/fit/training_source.h"
#include "training/night/consolidate_options.h"
#include "training/night/consolidate_plan.h"
#include "training/night/consolidate_report.h"

// Private to this room.

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// The time that an entity gets.
struct Allotment {
  Duration budget{};                ///< For training.
  std::optional<Time> end;          ///< Training ends then instead.
  std::optional<Time> encoded_end;  ///< With it: when encoding should have ended.
};

/// What to leave free for encoding that was measured to take so long. Unit: s.
[[nodiscard]] double with_encoding_margin(double seconds);

/// Offline work on one entity of one generation of a store.
class EntityJob {
 public:
  /// All but the entity outlive it.
  EntityJob(ltm::StoreReader& reader, ltm::MemoryId entity, const ConsolidateOptions& options,
            JobPace& pace);

  /// Finds the recorded snapshots, or the reason to skip the entity.
  Status plan();

  /// What will be done, as far as this entity alone can tell. After plan().
  [[nodiscard]] const EntityPlan& planned() const { return plan_; }

  /// How much of the training time this entity should get, beside others. Larger values need more
  /// of it, but not in proportion.
  [[nodiscard]] double weight() const;

  /// Measures on a sample how long everything after training will take. Unit: s; 0 where the
  /// entity is skipped.
  Result<double> measure_encoding();

  /// Trains, encodes and publishes where the entity is not skipped.
  Result<EntityReport> run(const Allotment& time);

  /// From now on the entity is skipped; what was kept of its training stays.
  Status skip_for_want_of_time(std::string reason);

 private:
  Status skip(std::string reason);
  /// Finds the bound of images, from their noise where none was given.
  Status choose_bound();
  /// Chooses between networks and video alone, once.
  Status choose_form();
  Status train_and_publish(const Allotment& time);
  /// Codes what has no latents yet with the newest model, and publishes that.
  Status encode_with_newest();
  /// Time to code everything as video alone; nothing where it is over.
  [[nodiscard]] std::optional<Allotment> second_allotment(const Allotment& first) const;
  Status train(const TrainOptions& train, const Allotment& time, const std::filesystem::path& file);
  [[nodiscard]] std::filesystem::path checkpoint_of(const TrainOptions& train);
  /// Removes checkpoints that nothing goes on from.
  void remove_stale_checkpoints(bool are_all_stale);
  [[nodiscard]] TrainingSource source();
  /// Finds what is trained on beside the recorded snapshots, where that was asked for.
  Status find_augmented_values();
  Result<std::shared_ptr<encoders::DeepModel>> train_new(const TrainOptions& options,
                                                         const Allotment& time);
  /// Trains a model and codes all snapshots with it. False where it has to be skipped.
  Result<bool> make(const TrainOptions& train, const Allotment& time);
  /// Codes some snapshots with a model; what comes back is measured into `report`.
  Result<std::vector<ltm::LatentSnapshot>> encode(const std::shared_ptr<encoders::DeepModel>& model,
                                                  int version,
                                                  std::span<const ltm::SnapshotEntry> entries,
                                                  const RepresentationOptions& representation,
                                                  EntityReport& report);
  /// Whether the entity can go on after this status. Where it cannot be coded, or the time is over,
  /// it is skipped.
  /// Errors: all others.
  Result<bool> goes_on_after(const Status& status);
  /// Writes the new model with what is known of it to file_.
  Status save();
  /// Compares the new model with the one before it. True where that is worth more: then its latents
  /// are what is to be published.
  Result<bool> goes_on_with_previous();
  /// The newest model of the store, where it can code these snapshots as is asked for; null, with a
  /// note, where not.
  Result<std::shared_ptr<encoders::DeepModel>> usable_previous();
  /// Bytes of the newest model's latents of a snapshot; nothing where it has none within the bound.
  Result<std::optional<double>> known_bytes(const encoders::DeepModel& previous,
                                            const ltm::SnapshotEntry& entry);
  /// Version of the model that made a snapshot's latents; 0 where it has none.
  [[nodiscard]] int version_of(const ltm::SnapshotEntry& entry) const;
  /// Whether latents of the newest model stay where those of all entries_ are replaced.
  Result<bool> is_previous_needed();
  /// Finds out whether networks for images could save five times their bytes, if their latents took
  /// none at all; chooses their width where nobody did.
  Result<bool> wants_networks();
  [[nodiscard]] bool video_is_cheaper();
  /// Bytes of a snapshot's images as video at the bound, from some evenly spaced runs.
  Result<double> sampled_video_bytes();
  /// Adds the images of a snapshot's first instance, one per image member.
  Status append_images(const ltm::SnapshotEntry& entry,
                       std::vector<std::vector<idf::NdArray>>& images);

  ltm::StoreReader& reader_;
  ltm::MemoryId entity_;
  const ConsolidateOptions& options_;
  JobPace& pace_;
  TrainOptions train_;  ///< As chosen.
  RepresentationOptions representation_;
  bool is_form_chosen_ = false;
  bool is_late_ = false;  ///< Nothing could be done for want of time.
  idf::Layout layout_;
  double plain_bytes_ = 0;
  std::vector<ltm::SnapshotEntry> entries_;
  std::optional<AugmentedValues> augmented_;
  std::vector<ltm::LatentSnapshot> latents_;
  std::shared_ptr<encoders::DeepModel> model_;  ///< That was made.
  std::optional<ltm::TemporaryFile> file_;      ///< Its file, to be published.
  EntityPlan plan_;
  EntityReport report_;
};

}  // namespace engram::training
