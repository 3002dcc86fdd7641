// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "training/night/choose_form.h"
#include "training/night/consolidate_report.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// The work on one entity after plan_entity: choose the form, fit, encode, compare, publish.
///
///     PlannedEntity --choose_form--> ChosenForm --fit_entity--> FittedModel
///       --encode_entity--> EncodedEntity --compare_models--> ComparedModels --publish--> store
///
/// The form comes before fitting: it decides whether networks for images are fitted at all. What is
/// known afterwards may choose video alone after all, then it is fitted and encoded once more.
/// `form`: where it was chosen already, to measure how long encoding takes.
/// Errors: those of the steps that concern more than this entity; else it is skipped.
Result<EntityReport> consolidate_entity(const EntityWork& work, const PlannedEntity& planned,
                                        const std::optional<ChosenForm>& form,
                                        const Allotment& time);

/// What is reported of an entity that stays as it is. Its checkpoints go, but where it is late:
/// then the next job goes on from them.
[[nodiscard]] EntityReport skip_entity(const EntityWork& work, const PlannedEntity& planned,
                                       const Skipped& skipped);

}  // namespace engram::training
