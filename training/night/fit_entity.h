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

/// What models of the entity are trained on: its recorded snapshots, what was made of them where
/// that was asked for, and the model that training goes on from. Work and plan outlive it.
/// Errors: those of find_augmented.
Result<TrainingSource> find_training_source(const EntityWork& work, const PlannedEntity& planned);

/// Fits a model in the time that is given, from its checkpoint where an earlier job kept one.
/// Errors: those of fit_model and add_condition.
Result<FittedModel> fit_entity(const EntityWork& work, const PlannedEntity& planned,
                               const TrainingSource& source, const ChosenForm& form,
                               const Allotment& time);

/// Where the training of such a model is kept; empty: nowhere.
[[nodiscard]] std::filesystem::path checkpoint_of(const EntityWork& work,
                                                  const TrainingSource& source,
                                                  const TrainOptions& train);

/// Removes the entity's checkpoints but for `kept`: nothing goes on from them. What fails is told
/// as a warning.
void remove_stale_checkpoints(const EntityWork& work,
                              std::span<const std::filesystem::path> kept = {});

}  // namespace engram::training
