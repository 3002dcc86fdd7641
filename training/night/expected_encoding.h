// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/night/choose_form.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// How long encoding will take, as measured on a sample. Unit: s; 0 where it cannot be measured,
/// since the entity will be skipped.
struct ExpectedEncoding {
  double seconds = 0;   ///< All snapshots once: what a report tells.
  double reserved = 0;  ///< Everything after training, with a margin.
};

/// What to leave free for encoding that was measured to take so long. Unit: s.
[[nodiscard]] double with_encoding_margin(double seconds);

/// Trains a model for two steps on the first snapshots, and codes these with it.
/// Errors: those of training and encoding, but for what skips an entity.
Result<ExpectedEncoding> measure_encoding(const EntityWork& work, const PlannedEntity& planned,
                                          const ChosenForm& form);

}  // namespace engram::training
