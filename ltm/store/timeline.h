// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "ltm/store/segment_reader.h"

namespace engram::ltm {

/// One snapshot of an entity and the locations of its forms.
struct SnapshotEntry {
  /// Rows in a segment, or a frame of a journal.
  struct Location {
    uint32_t source = 0;  ///< Index into the reader's segments or journals.
    uint32_t rows = 0;    ///< Number of instances; zero for a journal frame.
    uint64_t at = 0;      ///< First row, or the offset of the frame.
  };

  Time time{};
  std::optional<Location> recorded;
  std::optional<Location> latent;

  /// Adds a form that is newer than those already present. Latents belong to the recorded form
  /// before them, so a later update of the recorded form makes them obsolete.
  void put(bool is_latent, const Location& location) {
    if (!is_latent) latent.reset();
    (is_latent ? latent : recorded) = location;
  }
};

/// What one segment contains of an entity, according to the manifest.
struct TimelinePart {
  uint32_t segment = 0;  ///< Index into the manifest's segments.
  bool is_latent = false;
  Time first{};
  Time last{};
  uint64_t snapshots = 0;
  uint64_t rows = 0;
};

/// The snapshot times of one entity over all segments and journals, without loading them. A query
/// opens only the segments that can contain its answer.
///
/// If a time is in several places, the journal takes precedence over segments, and later segments
/// over earlier ones.
/// Errors: all functions return those of SegmentReader.
/// Threading: one thread.
class Timeline {
 public:
  /// Opens a segment. The result is used only until the next call of it or of a visit.
  using OpenSegment = std::function<Result<SegmentReader*>(uint32_t segment)>;

  /// `parts` are in the order of the manifest and none is empty. `journal` is in the order of time
  /// and has each time once. `open` must outlive it.
  Timeline(MemoryId entity, std::vector<TimelinePart> parts, std::vector<SnapshotEntry> journal,
           OpenSegment open);

  /// Times of the first and last snapshot, or nullopt if there is none.
  [[nodiscard]] std::optional<Time> first() const;
  [[nodiscard]] std::optional<Time> last() const;

  /// The first snapshot that is not before `time`.
  /// Complexity: O(segments + log rows).
  Result<std::optional<SnapshotEntry>> at_or_after(Time time);

  /// The last snapshot that is not after `time`.
  Result<std::optional<SnapshotEntry>> at_or_before(Time time);

  /// The snapshot with number `index`, counted from the first.
  /// Complexity: segments that share no times with others are skipped; in the others it is
  /// O(index).
  Result<std::optional<SnapshotEntry>> nth(uint64_t index);

  /// Number of distinct times.
  /// Complexity: like nth.
  Result<uint64_t> count();

  /// Visits the snapshots from `first` to `last`, inclusive, in the order of time, until a visit
  /// fails. A visit may read from the store and query this timeline.
  using Visit = std::function<Status(const SnapshotEntry&)>;
  Status for_each(Time first, Time last, const Visit& visit);
  Status for_each(const Visit& visit) { return for_each(Time::min(), Time::max(), visit); }

 private:
  /// Parts that share times, directly or through other parts.
  struct Cluster {
    Time first{};
    Time last{};
    std::vector<size_t> parts;  ///< Indices into parts_; parts_.size() is the journal.
    std::optional<uint64_t> count;
  };

  [[nodiscard]] Time first_of(size_t part) const;
  [[nodiscard]] Time last_of(size_t part) const;
  [[nodiscard]] bool is_journal(size_t part) const { return part == parts_.size(); }
  [[nodiscard]] size_t part_count() const { return parts_.size() + (journal_.empty() ? 0 : 1); }

  void make_clusters();
  Result<SegmentReader*> open(size_t part);
  Result<std::optional<Time>> part_at_or_after(size_t part, Time time);
  Result<std::optional<Time>> part_at_or_before(size_t part, Time time);
  Result<std::optional<RowSpan>> span_at_or_after(size_t part, Time time);
  Status add_entry(size_t part, SnapshotEntry& entry);
  Result<std::optional<SnapshotEntry>> entry_at(std::optional<Time> time);
  Status visit_part(size_t part, Time first, Time last, const Visit& visit);
  Result<uint64_t> count_of(Cluster& cluster);
  Result<std::optional<SnapshotEntry>> nth_of(const Cluster& cluster, uint64_t index);

  MemoryId entity_;
  std::vector<TimelinePart> parts_;
  std::vector<SnapshotEntry> journal_;
  OpenSegment open_;
  std::vector<Cluster> clusters_;
  std::vector<RowSpan> hints_;  ///< The snapshot found last in each part.
};

}  // namespace engram::ltm
