// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "ltm/memory/segment_types.h"
#include "ltm/store/segment_entities.h"

namespace engram::ltm {

/// Newest store format that this program reads and writes, and that of stores without segments of
/// many entities. Source: docs/format.md.
inline constexpr int kStoreFormatVersion = 3;
inline constexpr int kFirstStoreFormatVersion = 1;

enum class SegmentKind { kRecorded, kLatent };

struct SegmentInfo {
  std::string file;  ///< Relative to the store, "segments/000001.h5".
  SegmentKind kind = SegmentKind::kRecorded;
  uint64_t bytes = 0;
  uint64_t checksum = 0;  ///< XXH3-64 of the file.
  /// Number of the last journal whose data is in this segment; 0 if unknown. Only recorded segments
  /// have it.
  uint64_t last_journal = 0;
  SegmentEntities entities;

  /// As SegmentEntities::find.
  [[nodiscard]] const SegmentEntity* find(const MemoryId& entity) const {
    return entities.find(entity);
  }
};

struct ModelInfo {
  MemoryId entity;
  int version = 0;
  std::string file;  ///< Relative to the store, "models/...h5".
  uint64_t bytes = 0;
  uint64_t checksum = 0;  ///< XXH3-64 of the file.

  /// "Vision/RGB/head/cam v2".
  [[nodiscard]] std::string name() const;
};

/// Snapshots that filters dropped, by the name of the filter.
using DropReasons = std::map<std::string, uint64_t, std::less<>>;

/// Sums over the forgotten snapshots of an entity. The snapshots are gone, but reports still count
/// them.
struct ForgottenSums {
  uint64_t snapshots = 0;
  uint64_t raw_bytes = 0;      ///< Their plain size, in bytes.
  uint64_t dropped = 0;        ///< Dropped snapshots that were counted in the removed segments.
  uint64_t dropped_bytes = 0;  ///< Their plain bytes.
};

/// The published content of a store: one generation of it.
struct Manifest {
  std::string store_id;
  uint64_t generation = 0;
  uint64_t next_segment = 1;   ///< Number of the next segment file.
  uint64_t first_journal = 1;  ///< Journals below this number are sealed.
  uint64_t damaged = 0;  ///< Number of places in sealed journals where acknowledged data was lost.
  SegmentTypes types;    ///< The latest declared types. Each segment file also stores its own.
  std::map<MemoryId, ForgottenSums> forgotten;
  /// Reasons for which filters dropped snapshots, over all sessions. They reach the manifest when a
  /// journal is sealed. Drops of a killed session since its last seal are counted in the segments,
  /// but their reasons are lost.
  std::map<MemoryId, DropReasons> dropped_by;
  std::vector<SegmentInfo> segments;
  std::vector<ModelInfo> models;

  /// The format version that a program needs to read it.
  [[nodiscard]] int format_version() const;

  /// Unpacks what the segments contain. What changes or saves all of a store calls it first,
  /// because entities in damaged blocks are not found. Errors: kDataLoss naming the segment.
  [[nodiscard]] Status verify_entities() const;

  /// The model with the highest version, or null if the entity has no model.
  [[nodiscard]] const ModelInfo* newest_model(const MemoryId& entity) const;
};

/// Reads the manifest of a store.
/// Errors: kNotFound if `store` is not a directory or has no manifest; kFailedPrecondition if its
/// format is newer than this program's; kDataLoss if the manifest is damaged.
Result<Manifest> read_manifest(const std::filesystem::path& store);

/// Reads the generation of a manifest that was read a moment ago, without the rest: that of many
/// entities takes long.
/// Errors: those of read_manifest.
Result<uint64_t> read_generation(const std::filesystem::path& store);

/// Reads the manifest under the store's manifest lock, lets `change` edit it, and replaces it
/// atomically with the next generation.
/// Errors: those of read_manifest, of `change`, and kUnavailable, kResourceExhausted.
/// Threading: thread-safe, between processes too.
Status edit_manifest(const std::filesystem::path& store,
                     const std::function<Status(Manifest&)>& change);

/// Calls `act` with the manifest while nobody can edit it, and changes nothing itself.
/// Errors: those of read_manifest and of `act`; kUnavailable.
/// Threading: thread-safe, between processes too.
Status under_manifest_lock(const std::filesystem::path& store,
                           const std::function<Status(const Manifest&)>& act);

/// True if create_store can create a store here: `store` does not exist, is an empty directory, or
/// is a directory in which a process was killed while it created a store.
[[nodiscard]] bool is_store_absent(const std::filesystem::path& store);

/// Creates an empty store in `store`. Errors: kAlreadyExists if is_store_absent is false,
/// kUnavailable.
Status create_store(const std::filesystem::path& store);

}  // namespace engram::ltm
