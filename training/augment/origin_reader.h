// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/store/store_reader.h"
#include "training/augment/augment_options.h"

// Private to this room.

namespace engram::training {

/// The source of an augmented snapshot: a recorded snapshot, and the labels of its objects.
struct Origin {
  ltm::Snapshot snapshot;
  std::optional<idf::NdArray> labels;  ///< Labels of the entity of the mask, if there is one.
};

/// Reads origins from a store.
///
/// Both references must outlive this object.
/// Threading: one thread.
class OriginReader {
 public:
  enum class Missing { kImages, kMask };

  OriginReader(ltm::StoreReader& reader, const AugmentOptions& options)
      : reader_(reader), options_(options) {}

  /// The type of an entity's values, or null.
  [[nodiscard]] const idf::Type* type_of(const ltm::MemoryId& entity) const;

  /// Reads the origin for a snapshot. The result is empty, and `missing` says why, if the snapshot
  /// is no longer recorded, is augmented itself or has no images, or if the mask has no snapshot at
  /// that moment.
  /// Errors: the errors of the store; kInvalidArgument if the mask is not an image of labels.
  Result<std::optional<Origin>> read(const ltm::MemoryId& entity, const ltm::SnapshotEntry& entry,
                                     Missing& missing);

 private:
  Result<std::optional<idf::NdArray>> labels_at(Time time);

  ltm::StoreReader& reader_;
  const AugmentOptions& options_;
};

/// The changes from which recipes are drawn.
[[nodiscard]] std::vector<augmentation::ChangeChoice> choices_of(const AugmentOptions& options);

/// The entities to change.
/// Errors: kNotFound if there is none, or if the entity of the mask does not exist; the errors of
/// validate().
Result<std::vector<ltm::MemoryId>> entities_of(ltm::StoreReader& reader,
                                               const AugmentOptions& options);

}  // namespace engram::training
