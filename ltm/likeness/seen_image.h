// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/likeness/image_descriptor.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// The image that stands for a snapshot when it is compared: the first member of its first instance
/// that is one, in the order of the value; null if there is none. Valid as long as the snapshot.
[[nodiscard]] const idf::NdArray* image_of(const SnapshotResult& snapshot);

/// The image of a moment, described.
struct SeenImage {
  ImageSize size;
  std::vector<float> descriptor;  ///< [kDescriptorSize]
};

/// Nothing if the snapshot has no image, or if it is damaged: all others can be compared still.
/// Errors: those of EntityPast::read but for kDataLoss.
Result<std::optional<SeenImage>> see(EntityPast& past, Time moment);

/// The entities whose numbers a snapshot links to, each once, in the order of the value: the joints
/// of a camera's image.
/// Errors: those of reading the past.
Result<std::vector<MemoryId>> linked_entities(KnownPast& past, const MemoryId& entity,
                                              const SnapshotResult& snapshot);

/// The numbers of an entity at a moment, or at the last one before it: its floats, alone and in
/// arrays, at most 1,024. Integers are counts, times and names of things, whose distances mean
/// little. Empty if there are none, or if the snapshot is damaged.
/// Errors: those of reading the past but for kDataLoss.
Result<std::vector<double>> numbers_at(EntityPast& past, Time moment);

}  // namespace engram::ltm
