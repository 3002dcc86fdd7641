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

/// The rows of one snapshot in a segment.
struct RowSpan {
  Time time{};
  uint64_t first = 0;
  uint32_t rows = 0;
};

/// A snapshot, and when the memory took it.
struct ArrivedSnapshot {
  Time time{};
  Time arrived{};
};

/// How the recorded form of an entity is stored.
struct StoredForms {
  /// Names of the codecs, including those of groups of images.
  std::set<std::string> media_codecs;
  bool has_groups = false;  ///< At least one medium is stored in groups of images.
  /// Paths of the numbers that are stored in compressed columns. All other numbers are in plain
  /// datasets.
  std::set<std::string, std::less<>> columns;

  [[nodiscard]] bool has_columns() const { return !columns.empty(); }

  /// Adds the forms of another segment.
  void add(const StoredForms& other);
};

/// The contents of a segment according to the file itself.
struct SegmentContents {
  SegmentKind kind = SegmentKind::kRecorded;
  std::vector<MemoryId> entities;
  std::vector<Status> damaged;  ///< One error for each group that cannot be read.
};

/// Reads one published segment file. Safe on damaged files: checksums are verified on every read.
///
/// Threading: one thread.
/// Source: docs/format.md, section "Segment".
class SegmentReader {
 public:
  /// Opens a segment file.
  /// Errors: kNotFound, kDataLoss, kFailedPrecondition if the format is newer than this program's.
  static Result<std::unique_ptr<SegmentReader>> open(const std::filesystem::path& file);
  ~SegmentReader();

  /// The types that the values in the file were declared with.
  /// Errors: kDataLoss.
  Result<SegmentTypes> types() const;

  /// Lists the entities without the help of a manifest, and reports groups that cannot be read.
  /// Errors: kDataLoss if the file has no kind.
  Result<SegmentContents> contents() const;

  /// Errors: kNotFound, kDataLoss.
  Result<uint64_t> row_count(const MemoryId& entity);
  Result<Time> time_at(const MemoryId& entity, uint64_t row);
  Result<int> model_version(const MemoryId& entity) const;

  /// Bytes of the file that the entity's datasets occupy, or its share of those that it shares.
  Result<uint64_t> stored_bytes(const MemoryId& entity);

  /// How the entity is stored. Only for recorded segments. Errors: kNotFound, kDataLoss.
  Result<StoredForms> forms(const MemoryId& entity);

  /// The snapshots of an entity in file order, which is the order of time.
  /// Errors: kNotFound, kDataLoss.
  Result<std::vector<RowSpan>> index(const MemoryId& entity);

  /// The first row of the entity whose time is not before `time`, or the number of rows if there is
  /// none.
  /// Complexity: O(log rows); reads a few chunks of times.
  Result<uint64_t> lower_bound(const MemoryId& entity, Time time);

  /// The snapshot that begins at `row`, or nullopt after the last one.
  Result<std::optional<RowSpan>> snapshot_at(const MemoryId& entity, uint64_t row);

  /// The snapshots of an entity in file order, each with when the memory took it: the latest of its
  /// instances. One that does not tell (0) counts as taken at its own time.
  /// Errors: kNotFound, kDataLoss.
  /// Complexity: two columns are read as a whole.
  Result<std::vector<ArrivedSnapshot>> arrivals(const MemoryId& entity);
  /// Whether the file says when snapshots of the entity arrived; all arrived at their times if not.
  Result<bool> has_arrivals(const MemoryId& entity);

  /// Errors: kNotFound, kDataLoss naming file, object and row.
  Result<PackedSnapshot> read_recorded(const MemoryId& entity, const RowSpan& span);
  /// The same without media: their places in the values are `none`.
  Result<PackedSnapshot> read_values(const MemoryId& entity, const RowSpan& span);
  /// Rows of one block share a Buffer if they are read in order.
  Result<LatentSnapshot> read_latent(const MemoryId& entity, const RowSpan& span);
  /// How good the latents of each instance are, without their bytes.
  Result<std::vector<LatentQuality>> read_qualities(const MemoryId& entity, const RowSpan& span);

 private:
  struct State;
  explicit SegmentReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
