// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/night/choose_form.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// The expected time of encoding, measured on a sample. It is 0 if the entity will be skipped and
/// cannot be measured.
/// Unit: s.
struct ExpectedEncoding {
  double seconds = 0;   ///< Time for all snapshots once.
  double reserved = 0;  ///< Time for all work after training, with a margin.
  double per_snapshot = 0;
};

/// Time to reserve for encoding that takes `seconds` by measurement. Unit: s.
[[nodiscard]] double with_encoding_margin(double seconds);

/// Trains a model for two steps on some new snapshots and encodes these with it. Where images are
/// kept as video and there is nothing else, a single encode of a few of them tells enough.
/// Errors: the errors of training and encoding, except those for which an entity is skipped.
Result<ExpectedEncoding> measure_encoding(const EntityWork& work, const PlannedEntity& planned,
                                          const ChosenForm& form);

}  // namespace engram::training
