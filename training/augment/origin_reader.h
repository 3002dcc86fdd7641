// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/store/store_reader.h"
#include "training/augment/augment_options.h"

// Private to this room.

namespace engram::training {

/// What augmented snapshots are made of: a recorded snapshot, and where its objects are.
struct Origin {
  ltm::Snapshot snapshot;
  std::optional<idf::NdArray> labels;  ///< Of the entity of the mask, where there is one.
};

/// Reads them from a store.
///
/// Threading: one thread. Both references outlive it.
class OriginReader {
 public:
  enum class Missing { kImages, kMask };

  OriginReader(ltm::StoreReader& reader, const AugmentOptions& options)
      : reader_(reader), options_(options) {}

  /// The type of an entity's values; null where there is none.
  [[nodiscard]] const idf::Type* type_of(const ltm::MemoryId& entity) const;

  /// Nothing, and what is missing, where none can be made of a snapshot: it is not recorded any
  /// more, is augmented itself, or has no images; or the mask has nothing at its moment.
  /// Errors: those of the store; kInvalidArgument where the mask is no image of labels.
  Result<std::optional<Origin>> read(const ltm::MemoryId& entity, const ltm::SnapshotEntry& entry,
                                     Missing& missing);

 private:
  Result<std::optional<idf::NdArray>> labels_at(Time time);

  ltm::StoreReader& reader_;
  const AugmentOptions& options_;
};

/// What recipes are drawn from.
[[nodiscard]] std::vector<augmentation::ChangeChoice> choices_of(const AugmentOptions& options);

/// The entities that are changed.
/// Errors: kNotFound where there is none, or no entity of the mask; those of validate().
Result<std::vector<ltm::MemoryId>> entities_of(ltm::StoreReader& reader,
                                               const AugmentOptions& options);

}  // namespace engram::training
