// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "ltm/store/segment_reader.h"

namespace engram::ltm {

/// One snapshot of an entity and where its representations lie.
struct SnapshotEntry {
  /// Row span in a segment, or a frame of a journal.
  struct Location {
    uint32_t source = 0;  ///< Index into the reader's segments or journals.
    uint32_t rows = 0;    ///< Number of instances; zero for a journal frame.
    uint64_t at = 0;      ///< First row, or the offset of the frame.
  };

  Time time{};
  std::optional<Location> recorded;
  std::optional<Location> latent;

  /// Takes over a representation that comes after those that are there: latents were made of what
  /// was recorded before them, and are of the past where an update follows.
  void put(bool is_latent, const Location& location) {
    if (!is_latent) latent.reset();
    (is_latent ? latent : recorded) = location;
  }
};

/// What one segment holds of an entity, as the manifest tells it.
struct TimelinePart {
  uint32_t segment = 0;  ///< Index into the manifest's segments.
  bool is_latent = false;
  Time first{};
  Time last{};
  uint64_t snapshots = 0;
  uint64_t rows = 0;
};

/// The moments of one entity, over all segments and journals, without loading them: a question
/// opens only the segments in which its answer can lie.
///
/// Where a moment is in several places, the journal counts before segments and later segments
/// before earlier ones.
/// Errors: those of SegmentReader, everywhere.
/// Threading: one thread.
class Timeline {
 public:
  /// What it gives is used until it is called again, or a visit is.
  using OpenSegment = std::function<Result<SegmentReader*>(uint32_t segment)>;

  /// `parts` in the order of the manifest, none of them empty; `journal` in the order of time, each
  /// time once. `open` must outlive it.
  Timeline(MemoryId entity, std::vector<TimelinePart> parts, std::vector<SnapshotEntry> journal,
           OpenSegment open);

  /// Times of the first and last snapshot; nothing where there is none.
  [[nodiscard]] std::optional<Time> first() const;
  [[nodiscard]] std::optional<Time> last() const;

  /// The first snapshot that is not before `time`.
  /// Complexity: O(segments + log rows).
  Result<std::optional<SnapshotEntry>> at_or_after(Time time);

  /// The last snapshot that is not after `time`.
  Result<std::optional<SnapshotEntry>> at_or_before(Time time);

  /// Snapshot number `index`, counted from the first.
  /// Complexity: segments that share no time with others are skipped, in the rest it is O(index).
  Result<std::optional<SnapshotEntry>> nth(uint64_t index);

  /// Number of different times.
  /// Complexity: as nth.
  Result<uint64_t> count();

  /// Visits the snapshots from `first` to `last`, both included, in the order of time, until one
  /// visit fails. A visit may read from the store, and ask this timeline.
  using Visit = std::function<Status(const SnapshotEntry&)>;
  Status for_each(Time first, Time last, const Visit& visit);
  Status for_each(const Visit& visit) { return for_each(Time::min(), Time::max(), visit); }

 private:
  /// Parts that share times, directly or through others.
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
  std::vector<RowSpan> hints_;  ///< Per part, the snapshot that was found last.
};

}  // namespace engram::ltm
