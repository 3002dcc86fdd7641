// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "ltm/store/manifest.h"
#include "ltm/store/timeline.h"

namespace engram::ltm {

/// The segments that hold one snapshot. It has 8 bytes, because plans keep it for every snapshot.
struct SnapshotPlaces {
  static constexpr uint32_t kNowhere = UINT32_MAX;
  static constexpr uint32_t kJournal = UINT32_MAX - 1;

  uint32_t recorded = kNowhere;
  uint32_t latent = kNowhere;

  [[nodiscard]] static SnapshotPlaces of(const SnapshotEntry& entry);

  [[nodiscard]] bool is_sealed() const { return recorded != kJournal; }
  [[nodiscard]] bool has_recorded_segment() const { return recorded < kJournal; }
  [[nodiscard]] bool has_latents() const { return latent != kNowhere; }
};

/// Estimates the bytes that forgetting frees, snapshot by snapshot.
///
/// Images in groups do not count until all snapshots of their entity in the segment go. The images
/// that stay of a cut group are stored one by one, which may take more bytes than the whole group.
///
/// Threading: one thread.
class FreedBytes {
 public:
  /// Returns whether a recorded segment, given as an index into the manifest, holds groups of
  /// images of an entity. It is called once for each entity of a segment that loses a snapshot.
  using HasGroups = std::function<bool(uint32_t segment, const MemoryId& entity)>;

  /// `manifest` must outlive this.
  FreedBytes(const Manifest& manifest, HasGroups has_groups);

  /// Counts an existing snapshot. All must be counted before any is taken.
  void count(const MemoryId& entity, const SnapshotPlaces& places);

  /// Takes a counted snapshot.
  void take(const MemoryId& entity, const SnapshotPlaces& places);

  /// The expected bytes: a segment that goes whole frees its file, in others each snapshot frees
  /// its share.
  [[nodiscard]] uint64_t expected() const { return exact_ + static_cast<uint64_t>(shares_); }

  /// A low estimate: shares in segments that stay in part count less, because columns and blocks
  /// of fewer rows compress worse and a part of each file does not shrink. It assumes that blocks
  /// of latents go whole; a block that is only cut frees no bytes.
  [[nodiscard]] uint64_t careful() const;

  /// The present share of one snapshot that was taken.
  [[nodiscard]] double share(const MemoryId& entity, const SnapshotPlaces& places) const;

 private:
  /// The snapshots of an entity in a segment.
  struct Part {
    double each = 0;          ///< Bytes of one snapshot.
    uint64_t left = 0;        ///< Counted snapshots that stay.
    uint64_t went = 0;        ///< Snapshots that were taken.
    bool has_groups = false;  ///< Valid once a snapshot was taken.

    [[nodiscard]] bool counts() const { return !has_groups || left == 0; }
    [[nodiscard]] double shares() const { return counts() ? each * static_cast<double>(went) : 0; }
  };

  struct Segment {
    std::map<MemoryId, Part> parts;
    uint64_t bytes = 0;
    uint64_t left = 0;  ///< Counted snapshots that stay.
    double shares = 0;  ///< Bytes of the snapshots that were taken.
    bool is_recorded = false;
  };

  [[nodiscard]] double share_in(uint32_t segment, const MemoryId& entity) const;
  void count_in(uint32_t segment, const MemoryId& entity);
  void take_from(uint32_t segment, const MemoryId& entity);

  HasGroups has_groups_;
  std::vector<Segment> segments_;
  double shares_ = 0;   ///< Expected bytes in segments that stay in part.
  uint64_t exact_ = 0;  ///< Bytes of segments that go whole.
};

}  // namespace engram::ltm
