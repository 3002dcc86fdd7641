// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "training/fit/trainer.h"
#include "training/fit/training_source.h"
#include "training/night/choose_form.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// Returns the training data of an entity: its recorded snapshots, their augmented values if
/// requested, and the model that training starts from. Work and plan must outlive the result.
/// Errors: the errors of find_augmented.
Result<TrainingSource> find_training_source(const EntityWork& work, const PlannedEntity& planned);

/// Fits a model in the given time, starting from a checkpoint if an earlier job kept one.
/// Errors: the errors of fit_model and add_condition.
Result<FittedModel> fit_entity(const EntityWork& work, const PlannedEntity& planned,
                               const TrainingSource& source, const ChosenForm& form,
                               const Allotment& time);

/// File of the checkpoint of such a training; empty if none is kept.
[[nodiscard]] std::filesystem::path checkpoint_of(const EntityWork& work,
                                                  const TrainingSource& source,
                                                  const TrainOptions& train);

/// Removes the entity's checkpoints except `kept`, because no training continues from them. A
/// failure is logged as a warning.
void remove_stale_checkpoints(const EntityWork& work,
                              std::span<const std::filesystem::path> kept = {});

}  // namespace engram::training
