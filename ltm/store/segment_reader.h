// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ltm/memory/segment_types.h"
#include "ltm/store/latent.h"
#include "ltm/store/manifest.h"
#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// Where one snapshot lies in a segment.
struct RowSpan {
  Time time{};
  uint64_t first = 0;
  uint32_t rows = 0;
};

/// How the recorded form of an entity is stored.
struct StoredForms {
  std::set<std::string> media_codecs;  ///< Names; those of groups of images, too.
  bool has_groups = false;             ///< Images of one medium or more are stored in groups.
  /// Paths of the numbers in compressed columns; all others are in plain datasets.
  std::set<std::string, std::less<>> columns;

  [[nodiscard]] bool has_columns() const { return !columns.empty(); }

  /// Takes over what another segment holds in each form.
  void add(const StoredForms& other);
};

/// What a segment file says of itself.
struct SegmentContents {
  SegmentKind kind = SegmentKind::kRecorded;
  std::vector<MemoryId> entities;
  std::vector<Status> damaged;  ///< Why groups cannot be read: one each.
};

/// Reads one published segment file. Safe on damaged files: checksums are verified on reading.
///
/// Threading: one thread.
/// Source: docs/format.md, section "Segment".
class SegmentReader {
 public:
  /// Errors: kNotFound, kDataLoss, kFailedPrecondition where the format is newer.
  static Result<std::unique_ptr<SegmentReader>> open(const std::filesystem::path& file);
  ~SegmentReader();

  /// The types that the file's values came under.
  /// Errors: kDataLoss.
  Result<SegmentTypes> types() const;

  /// Looks for entities without the help of a manifest. Groups that cannot be read are told.
  /// Errors: kDataLoss where the file has no kind.
  Result<SegmentContents> contents() const;

  /// Errors: kNotFound, kDataLoss.
  Result<uint64_t> row_count(const MemoryId& entity);
  Result<Time> time_at(const MemoryId& entity, uint64_t row);
  Result<int> model_version(const MemoryId& entity) const;

  /// Bytes of the file that the entity's datasets take.
  Result<uint64_t> stored_bytes(const MemoryId& entity) const;

  /// Of recorded segments. Errors: kNotFound, kDataLoss.
  Result<StoredForms> forms(const MemoryId& entity);

  /// Snapshots of an entity in the order of the file, which is that of time.
  /// Errors: kNotFound, kDataLoss.
  Result<std::vector<RowSpan>> index(const MemoryId& entity);

  /// The first row of the entity whose time is not before `time`, or the number of rows.
  /// Complexity: O(log rows); reads a few chunks of times.
  Result<uint64_t> lower_bound(const MemoryId& entity, Time time);

  /// The snapshot that begins at `row`; nothing behind the last one.
  Result<std::optional<RowSpan>> snapshot_at(const MemoryId& entity, uint64_t row);

  /// Errors: kNotFound, kDataLoss naming file, object and row.
  Result<PackedSnapshot> read_recorded(const MemoryId& entity, const RowSpan& span);
  /// Rows of one block share a Buffer where they are read in their order.
  Result<LatentSnapshot> read_latent(const MemoryId& entity, const RowSpan& span);

 private:
  struct State;
  explicit SegmentReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
