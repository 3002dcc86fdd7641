// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/deep_model.h"
#include "training/night/choose_form.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room: includes LibTorch.

namespace engram::training {

/// Whether the snapshot that a reference was made of is still there, in any form. A picture of what
/// was forgotten must not serve new videos.
/// Errors: the errors of the store.
Result<bool> is_remembered(const EntityWork& work, const encoders::VideoReference& reference);

/// Adds references to a new model that keeps images as AV1 video: those of the newest model that
/// are still worth their bytes, and new ones. Nothing happens where there are too few chains, or
/// where the time does not suffice.
/// Errors: the errors of the store and of the codec.
/// Source: docs/learning_methods.md, section "References".
Status add_references(const EntityWork& work, const PlannedEntity& planned, const ChosenForm& form,
                      const Allotment& time, encoders::DeepModel& model);

}  // namespace engram::training
