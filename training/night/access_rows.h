// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "training/forms/representation.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// What reading one snapshot of a chain costs: so much, and so much more for each row before it.
/// Unit: s.
struct DecodingTime {
  double once = 0;
  double per_row = 0;
};

/// Returns the length of a chain whose last row is decoded within `access`, with a quarter of that
/// time left for everything else that a query does. It is one of a few lengths, so that two
/// measurements of one machine seldom differ: a chain of 64 rows is the longest one, because longer
/// ones save little.
[[nodiscard]] int rows_within(Duration access, const DecodingTime& decoding);

/// Measures how long videos of an entity's images decode on this machine, from an encode of a few
/// of its snapshots. Where no codec takes the images, it is estimated by their `pixels`, of all
/// members.
/// Errors: kInvalidArgument if a snapshot has another layout; the errors of the store.
Result<DecodingTime> measure_decoding(const EntityWork& work, const PlannedEntity& planned,
                                      const RepresentationOptions& representation, int64_t pixels);

}  // namespace engram::training
