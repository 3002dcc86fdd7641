// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/night/choose_form.h"
#include "training/night/consolidate_report.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// Keeps images as video, where no networks are trained. There is nothing to compare in the end, so
/// what is encoded is published every few minutes, and a job that is killed loses no more.
///
/// It goes on with the newest model if that is of video alone too: then only what has no latents of
/// it is encoded. Otherwise it publishes a new model with the first group.
/// `form` must be of video alone. It learns from the searches for videos.
/// Errors: those that end the whole job.
Result<OrSkipped<EntityReport>> keep_as_video(const EntityWork& work, const PlannedEntity& planned,
                                              const ChosenForm& form, const Allotment& time);

}  // namespace engram::training
