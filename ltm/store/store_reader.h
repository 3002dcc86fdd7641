// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/memory/snapshot.h"
#include "ltm/store/latent.h"
#include "ltm/store/manifest.h"
#include "ltm/store/packed_snapshot.h"
#include "ltm/store/timeline.h"

namespace engram::ltm {

/// Everything `engram info` says of one entity.
struct EntitySummary {
  MemoryId id;
  uint64_t snapshots = 0;  ///< Distinct times, whatever their representation.
  Time first{};
  Time last{};
  uint64_t recorded_snapshots = 0;
  uint64_t latent_snapshots = 0;
  uint64_t augmented_snapshots = 0;  ///< Made of others; later updates of one time count again.
  uint64_t raw_bytes = 0;            ///< Plain bytes of the snapshots that were kept.
  uint64_t offered = 0;              ///< Snapshots that came in, dropped ones included.
  uint64_t offered_bytes = 0;        ///< Their plain bytes.
  uint64_t stored_bytes = 0;         ///< Recorded form: segments and journal.
  uint64_t latent_bytes = 0;         ///< Latents, without models; blocks count once.
  uint64_t model_bytes = 0;          ///< All model files of the entity.
  ForgottenSums forgotten;           ///< Counted in `offered` too.
  DropReasons dropped_by;            ///< Why filters dropped, as far as it is known.
  std::vector<ModelInfo> models;
  LatentSums latent;  ///< Over all latent segments; the newest model's version.
};

/// Reads one generation of a store, unsealed journal included. Later changes are not seen. Groups
/// of images that were decoded last are kept, see MediumDecoder.
///
/// Threading: one thread. Any number of readers run beside each other and beside a writer.
/// Source: docs/format.md.
class StoreReader {
 public:
  /// Errors: those of read_manifest; kDataLoss where a published file is missing or damaged.
  static Result<std::unique_ptr<StoreReader>> open(const std::filesystem::path& store);
  ~StoreReader();

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const Manifest& manifest() const;

  /// In the order of their names.
  [[nodiscard]] std::vector<MemoryId> entities() const;

  /// Complexity: O(log n).
  [[nodiscard]] bool has(const MemoryId& entity) const;

  /// Errors: kNotFound naming the entity and the ones there are.
  Result<EntitySummary> summary(const MemoryId& entity);

  /// The moments of the entity; valid as long as the reader.
  /// Errors: kNotFound.
  Result<Timeline*> timeline(const MemoryId& entity);

  /// All snapshots of the entity in the order of time, in memory; valid as long as the reader. For
  /// those who read them all; who looks for some asks the timeline.
  /// Errors: kNotFound, kDataLoss; here and when reading, kUnavailable where a consolidation
  /// replaced a segment meanwhile: open the store again.
  Result<const std::vector<SnapshotEntry>*> index(const MemoryId& entity);

  /// Places in journals, sealed ones included, where acknowledged data was found damaged.
  [[nodiscard]] uint64_t damaged_places() const;

  /// The recorded form as it is stored. Needs `entry.recorded` (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<PackedSnapshot> read_packed(const MemoryId& entity, const SnapshotEntry& entry);

  /// How the entity is stored in a recorded segment: an index into the manifest's (checked).
  /// Errors: kNotFound, kDataLoss.
  Result<StoredForms> forms(const MemoryId& entity, uint32_t segment);

  /// How the entity is stored in the newest segments that hold it.
  /// Errors: kDataLoss.
  Result<StoredForms> newest_forms(const MemoryId& entity);

  /// Decodes the recorded form. Needs `entry.recorded` (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<Snapshot> read_recorded(const MemoryId& entity, const SnapshotEntry& entry);

  /// Whether the recorded form was made of another snapshot by changing it on purpose. Needs
  /// `entry.recorded` (checked). Errors: as read_packed.
  Result<bool> is_augmented(const MemoryId& entity, const SnapshotEntry& entry);

  /// Reads the latents. Needs `entry.latent` (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<LatentSnapshot> read_latent(const MemoryId& entity, const SnapshotEntry& entry);

 private:
  struct State;
  explicit StoreReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
