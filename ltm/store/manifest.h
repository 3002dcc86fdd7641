// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "ltm/memory/segment_types.h"

namespace engram::ltm {

/// Newest format of a store that this program reads and writes. Source: docs/format.md.
inline constexpr int kStoreFormatVersion = 1;

enum class SegmentKind { kRecorded, kLatent };

/// Sums over the latents of one entity in one segment, so that reports open no segment.
struct LatentSums {
  int model_version = 0;
  uint64_t image_rows = 0;   ///< Rows with image members.
  double psnr_db = 0;        ///< Sum over image rows; each capped at 60 dB.
  double image_mse = 0;      ///< Sum over image rows.
  uint64_t number_rows = 0;  ///< Rows with numeric members.
  double number_mse = 0;     ///< Sum over number rows.
};

/// What one segment file holds of one entity.
struct SegmentEntity {
  MemoryId id;
  uint64_t snapshots = 0;
  uint64_t rows = 0;  ///< Instances.
  Time first{};
  Time last{};
  uint64_t raw_bytes = 0;         ///< Of these snapshots, plain.
  uint64_t stored_bytes = 0;      ///< Of this entity in the file.
  uint64_t dropped = 0;           ///< Snapshots that the online filters dropped in this span.
  uint64_t dropped_bytes = 0;     ///< Their plain bytes.
  LatentSums latent;              ///< Only in latent segments.
  uint64_t augmented = 0;         ///< Of the snapshots, those that were made of others.
};

struct SegmentInfo {
  std::string file;  ///< Relative to the store, "segments/000001.h5".
  SegmentKind kind = SegmentKind::kRecorded;
  uint64_t bytes = 0;
  uint64_t checksum = 0;  ///< XXH3-64 of the file.
  /// The last journal that anything in a recorded segment came from; 0 where nobody knows.
  uint64_t last_journal = 0;
  std::vector<SegmentEntity> entities;

  /// Null where the segment has nothing of it.
  [[nodiscard]] const SegmentEntity* find(const MemoryId& entity) const;
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

/// What was forgotten of an entity: it is gone, but counted.
struct ForgottenSums {
  uint64_t snapshots = 0;
  uint64_t raw_bytes = 0;      ///< Plain bytes of them.
  uint64_t dropped = 0;        ///< What filters had dropped, told of in segments that went.
  uint64_t dropped_bytes = 0;  ///< Their plain bytes.
};

/// The published content of a store: one generation of it.
struct Manifest {
  std::string store_id;
  uint64_t generation = 0;
  uint64_t next_segment = 1;   ///< Number of the next segment file.
  uint64_t first_journal = 1;  ///< Journals below this number are sealed.
  uint64_t damaged = 0;        ///< Places in sealed journals where acknowledged data was lost.
  SegmentTypes types;          ///< As they were declared last; segment files have their own.
  std::map<MemoryId, ForgottenSums> forgotten;
  /// Why filters dropped, over all sessions. Reaches the manifest when a journal is sealed: what a
  /// killed session dropped since then is in the counts of the segments, without its reason.
  std::map<MemoryId, DropReasons> dropped_by;
  std::vector<SegmentInfo> segments;
  std::vector<ModelInfo> models;

  /// The model of the highest version; null where the entity has none.
  [[nodiscard]] const ModelInfo* newest_model(const MemoryId& entity) const;
};

/// Errors: kNotFound where `store` is no directory or holds no manifest; kFailedPrecondition where
/// its format is newer; kDataLoss where the manifest is broken.
Result<Manifest> read_manifest(const std::filesystem::path& store);

/// Reads the manifest under the store's manifest lock, lets `change` edit it, and replaces it
/// atomically with the next generation.
/// Errors: those of read_manifest, of `change`, and kUnavailable, kResourceExhausted.
/// Threading: thread-safe, between processes too.
Status edit_manifest(const std::filesystem::path& store,
                     const std::function<Status(Manifest&)>& change);

/// True where create_store may make a store: nothing there, an empty directory, or one in which a
/// process was killed while it made a store.
[[nodiscard]] bool is_store_absent(const std::filesystem::path& store);

/// Makes an empty store in `store`. Errors: kAlreadyExists where something is there, kUnavailable.
Status create_store(const std::filesystem::path& store);

}  // namespace engram::ltm
