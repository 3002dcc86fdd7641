// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/memory/snapshot.h"
#include "ltm/store/entity_times.h"
#include "ltm/store/latent.h"
#include "ltm/store/manifest.h"
#include "ltm/store/packed_snapshot.h"
#include "ltm/store/timeline.h"

namespace engram::ltm {

/// Everything that `engram info` reports about one entity.
struct EntitySummary {
  MemoryId id;
  uint64_t snapshots = 0;  ///< Number of distinct times, in any form.
  Time first{};
  Time last{};
  uint64_t recorded_snapshots = 0;
  uint64_t latent_snapshots = 0;
  /// Augmented snapshots; each update of the same time counts again.
  uint64_t augmented_snapshots = 0;
  uint64_t raw_bytes = 0;      ///< Plain bytes of the kept snapshots.
  uint64_t offered = 0;        ///< Snapshots that arrived, including those that filters dropped.
  uint64_t offered_bytes = 0;  ///< Their plain bytes.
  uint64_t stored_bytes = 0;   ///< Bytes of the recorded form in segments and journals.
  uint64_t latent_bytes = 0;   ///< Bytes of the latents, without models. A block counts once.
  uint64_t model_bytes = 0;    ///< All model files of the entity.
  ForgottenSums forgotten;     ///< Also counted in `offered`.
  DropReasons dropped_by;      ///< Reasons for which filters dropped snapshots, as far as known.
  std::vector<ModelInfo> models;
  LatentSums latent;  ///< Sums over all latent segments, with the newest model's version.
};

/// Reads one generation of a store, including unsealed journals. Later changes are not visible. The
/// groups of images decoded last are kept in memory, see MediumDecoder.
///
/// Threading: one thread. Any number of readers may run beside each other and beside a writer.
/// Source: docs/format.md.
class StoreReader {
 public:
  /// Opens a store. Errors: those of read_manifest; kDataLoss if a published file is missing or
  /// damaged.
  static Result<std::unique_ptr<StoreReader>> open(const std::filesystem::path& store);
  ~StoreReader();

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const Manifest& manifest() const;

  /// All entities, in the order of their names.
  [[nodiscard]] std::vector<MemoryId> entities() const;

  /// Does not depend on how many others there are.
  [[nodiscard]] bool has(const MemoryId& entity) const;

  /// The time of the last snapshot in unsealed journals, of each entity that has one there.
  [[nodiscard]] std::map<MemoryId, std::optional<Time>> journal_times() const;

  /// Errors: kNotFound naming the entity and the existing ones.
  Result<EntitySummary> summary(const MemoryId& entity);

  /// The timeline of the entity, valid as long as the reader.
  /// Errors: kNotFound.
  Result<Timeline*> timeline(const MemoryId& entity);

  /// All snapshots of the entity in the order of time, in memory, valid as long as the reader. Use
  /// it to read them all; to find a few, query the timeline instead.
  /// Errors: kNotFound, kDataLoss; here and when reading, kUnavailable if a consolidation replaced
  /// a segment meanwhile; open the store again then.
  Result<const std::vector<SnapshotEntry>*> index(const MemoryId& entity);

  /// The times of all snapshots of the entity, for who counts many of them. Nothing else of them is
  /// read.
  /// Errors: those of index().
  /// Complexity: the time column of each segment is read as a whole.
  Result<EntityTimes> times(const MemoryId& entity);

  /// The snapshots of the entity that are in journals, in the order of time; empty if it has none
  /// there. Reads nothing.
  [[nodiscard]] std::vector<SnapshotEntry> unsealed(const MemoryId& entity) const;

  /// The number of the journal that a location with zero rows is in. No other journal of this store
  /// ever has it.
  [[nodiscard]] uint64_t journal_number(const SnapshotEntry::Location& in_journal) const;

  /// Number of places in journals, including sealed ones, where acknowledged data was damaged.
  [[nodiscard]] uint64_t damaged_places() const;

  /// Reads the recorded form in packed form. Needs `entry.recorded` (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<PackedSnapshot> read_packed(const MemoryId& entity, const SnapshotEntry& entry);

  /// The same for who needs no images: in segments, media are not read and missing from the result.
  Result<PackedSnapshot> read_values(const MemoryId& entity, const SnapshotEntry& entry);

  /// All snapshots of an entity in the order of time, each with when the memory took it: the latest
  /// of its instances; its own time if it does not tell. Of a time that is in several places the
  /// newest counts.
  /// Errors: kNotFound, kUnavailable; kDataLoss naming the segment.
  /// Complexity: O(snapshots), without reading any value; what is in journals is read.
  Result<std::vector<ArrivedSnapshot>> arrivals(const MemoryId& entity);

  /// Whether all snapshots of the entity arrived at their own times, as those of an import did. No
  /// rows are read for it. False if a journal has some of them.
  /// Errors: kNotFound, kDataLoss.
  Result<bool> arrived_in_time(const MemoryId& entity);

  /// How the entity is stored in a recorded segment. `segment` is an index into the manifest's
  /// segments (checked).
  /// Errors: kNotFound, kDataLoss.
  Result<StoredForms> forms(const MemoryId& entity, uint32_t segment);

  /// How the entity is stored in the newest segments that contain it.
  /// Errors: kDataLoss.
  Result<StoredForms> newest_forms(const MemoryId& entity);

  /// Decodes the recorded form. Needs `entry.recorded` (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<Snapshot> read_recorded(const MemoryId& entity, const SnapshotEntry& entry);

  /// True if the recorded form is augmented, that is, made from another snapshot by changing it on
  /// purpose. Needs `entry.recorded` (checked). Errors: those of read_packed.
  Result<bool> is_augmented(const MemoryId& entity, const SnapshotEntry& entry);

  /// Reads the latents. Needs `entry.latent` (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<LatentSnapshot> read_latent(const MemoryId& entity, const SnapshotEntry& entry);

  /// How good the latents of each instance are, without reading them. Needs `entry.latent`
  /// (checked).
  /// Errors: kDataLoss naming the segment and the row.
  Result<std::vector<LatentQuality>> read_qualities(const MemoryId& entity,
                                                    const SnapshotEntry& entry);

 private:
  struct State;
  explicit StoreReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
