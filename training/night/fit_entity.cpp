// SPDX-License-Identifier: Apache-2.0
#include "training/night/fit_entity.h"

#include "ltm/core/free_memory.h"
#include "ltm/core/log.h"
#include "ltm/store/checkpoint_file.h"
#include "training/fit/augmented_source.h"
#include "training/fit/checkpoint.h"
#include "training/fit/condition_source.h"
#include "training/fit/entity_source.h"
#include "training/night/entity_references.h"
#include "training/night/model_of_latents.h"

namespace engram::training {

namespace {

int64_t forgotten_of(const ltm::Manifest& manifest, const ltm::MemoryId& entity,
                     const std::string& condition) {
  int64_t forgotten = 0;
  for (const auto& [id, sums] : manifest.forgotten)
    if (id == entity || id.to_string() == condition)
      forgotten += static_cast<int64_t>(sums.snapshots);
  return forgotten;
}

}  // namespace

Result<TrainingSource> find_training_source(const EntityWork& work, const PlannedEntity& planned) {
  const auto stage = work.stage(Stage::kTraining);
  TrainingSource source =
      EntitySource::values(work.reader, work.entity, planned.layout, planned.entries);
  const ltm::ModelInfo* newest = work.reader.manifest().newest_model(work.entity);
  if (newest != nullptr && !work.options.starts_anew) {
    source.previous = {work.reader.path() / newest->file, newest->version, newest->checksum};
    for (const ltm::SnapshotEntry& entry : planned.entries)
      source.is_known.push_back(version_of_latents(work, entry) == newest->version);
  }
  if (work.options.augmented.empty()) return source;
  ENGRAM_ASSIGN_OR_RETURN(
      AugmentedValues augmented,
      find_augmented(work.options.augmented, work.entity, source, work.pace.stop()));
  if (!augmented.origins.empty() || augmented.left_out > 0) source.augmented = std::move(augmented);
  return source;
}

Result<FittedModel> fit_entity(const EntityWork& work, const PlannedEntity& planned,
                               const TrainingSource& source, const ChosenForm& form,
                               const Allotment& time) {
  const auto stage = work.stage(Stage::kTraining);
  TrainOptions train = form.train;
  train.budget = time.budget;
  const TrainControl control{.end = time.end,
                             .checkpoint = checkpoint_of(work, source, form.train),
                             .checkpoint_interval = work.options.job.checkpoint_interval,
                             .pace = &work.pace};
  TrainingSource values = source;
  // The newest snapshot is used, because links of the first one may lead to forgotten snapshots.
  ENGRAM_RETURN_IF_ERROR(add_condition(work.reader, work.entity, planned.entries.back(), values));
  values.forgotten = forgotten_of(work.reader.manifest(), work.entity, values.condition_entity);
  ENGRAM_ASSIGN_OR_RETURN(FittedModel fitted, fit_model(values, train, work.pace.progress(),
                                                        work.pace.stop(), control));
  give_back_memory();
  if (!form.train.has_networks)
    ENGRAM_RETURN_IF_ERROR(add_references(work, planned, form, time, *fitted.model));
  return fitted;
}

std::filesystem::path checkpoint_of(const EntityWork& work, const TrainingSource& source,
                                    const TrainOptions& train) {
  if (work.options.job.checkpoint_interval == Duration::zero()) return {};
  // Checkpoints do not contain the state that other variants keep outside the model.
  if (train.variant != encoders::TrainingVariant::kRateAware) return {};
  return ltm::checkpoint_file(work.reader.path(), work.entity, checkpoint_key(source, train));
}

void remove_stale_checkpoints(const EntityWork& work, std::span<const std::filesystem::path> kept) {
  const Status removed = ltm::remove_checkpoints(work.reader.path(), work.entity, kept);
  if (!removed.ok()) log::warning("a stale checkpoint stays: {}", removed.message());
}

}  // namespace engram::training
