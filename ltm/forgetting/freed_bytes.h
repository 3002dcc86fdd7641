// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "ltm/store/manifest.h"
#include "ltm/store/timeline.h"

namespace engram::ltm {

/// The segments that hold one snapshot, in 8 bytes: plans remember them of every snapshot.
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

/// Estimates what forgetting frees, snapshot by snapshot.
///
/// Images of a group do not count until all that the segment holds of their entity goes: those that
/// stay of a group that is cut are stored one by one, which may take more bytes than all of it did.
///
/// Threading: one thread.
class FreedBytes {
 public:
  /// Says of a recorded segment, an index into the manifest's, whether it holds groups of images of
  /// an entity. It is asked once about each entity of a segment that loses anything.
  using HasGroups = std::function<bool(uint32_t segment, const MemoryId& entity)>;

  /// `manifest` must outlive this.
  FreedBytes(const Manifest& manifest, HasGroups has_groups);

  /// Tells of a snapshot that is there, before any goes.
  void count(const MemoryId& entity, const SnapshotPlaces& places);

  /// A counted snapshot goes.
  void take(const MemoryId& entity, const SnapshotPlaces& places);

  /// A segment that goes whole frees its file; of others each snapshot its share.
  [[nodiscard]] uint64_t expected() const { return exact_ + static_cast<uint64_t>(shares_); }

  /// What they free at least: shares in segments of which something stays count less, as columns
  /// and blocks of fewer rows compress worse and files have a part that does not shrink. Blocks of
  /// latents are taken to go whole: of those that are only cut no bytes go.
  [[nodiscard]] uint64_t careful() const { return exact_ + static_cast<uint64_t>(careful_); }

  /// The share of one snapshot that went, as it stands now.
  [[nodiscard]] double share(const MemoryId& entity, const SnapshotPlaces& places) const;

 private:
  /// What a segment holds of an entity.
  struct Part {
    double each = 0;    ///< Bytes of one snapshot.
    uint64_t left = 0;  ///< Counted snapshots that stay.
    uint64_t went = 0;
    bool has_groups = false;  ///< Known once one went.

    [[nodiscard]] bool counts() const { return !has_groups || left == 0; }
    [[nodiscard]] double shares() const { return counts() ? each * static_cast<double>(went) : 0; }
  };

  struct Segment {
    std::map<MemoryId, Part> parts;
    uint64_t bytes = 0;
    uint64_t left = 0;  ///< Counted snapshots that stay.
    double shares = 0;  ///< Of those that went.
    bool is_recorded = false;
  };

  [[nodiscard]] double share_in(uint32_t segment, const MemoryId& entity) const;
  void count_in(uint32_t segment, const MemoryId& entity);
  void take_from(uint32_t segment, const MemoryId& entity);

  HasGroups has_groups_;
  std::vector<Segment> segments_;
  double shares_ = 0;   ///< In segments of which something stays.
  double careful_ = 0;  ///< What is counted on of them.
  uint64_t exact_ = 0;  ///< Of segments that go whole.
};

}  // namespace engram::ltm
