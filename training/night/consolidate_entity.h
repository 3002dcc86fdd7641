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
/// The form is chosen before fitting, because it decides whether networks for images are fitted at
/// all. If video alone turns out to be smaller after encoding, fitting and encoding are repeated
/// without networks. `form` is given if it was chosen already to measure the time of encoding.
/// Errors: errors of the steps that concern more than this entity; for other errors the entity is
/// skipped.
Result<EntityReport> consolidate_entity(const EntityWork& work, const PlannedEntity& planned,
                                        const std::optional<ChosenForm>& form,
                                        const Allotment& time);

/// Returns the report of an entity that stays unchanged. Its checkpoints are removed unless the
/// time was over: then the next job continues from them.
[[nodiscard]] EntityReport skip_entity(const EntityWork& work, const PlannedEntity& planned,
                                       const Skipped& skipped);

}  // namespace engram::training
