// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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
/// Threading: one thread.
class FreedBytes {
 public:
  /// `manifest` must outlive this.
  explicit FreedBytes(const Manifest& manifest);

  /// Tells of a snapshot that is there, before any goes.
  void count(const SnapshotPlaces& places);

  /// A counted snapshot goes.
  void take(const MemoryId& entity, const SnapshotPlaces& places);

  /// A segment that goes whole frees its file; of others each snapshot its share.
  [[nodiscard]] uint64_t expected() const { return exact_ + static_cast<uint64_t>(shares_); }

  /// What they free at least: shares in segments of which something stays count less, as columns
  /// and blocks of fewer rows compress worse and files have a part that does not shrink. Blocks of
  /// latents are taken to go whole: of those that are only cut no bytes go.
  [[nodiscard]] uint64_t careful() const { return exact_ + static_cast<uint64_t>(careful_); }

  /// The share of one snapshot.
  [[nodiscard]] double share(const MemoryId& entity, const SnapshotPlaces& places) const;

 private:
  struct Segment {
    std::map<MemoryId, double> each;  ///< Bytes of one snapshot.
    uint64_t bytes = 0;
    uint64_t left = 0;  ///< Counted snapshots that stay.
    double shares = 0;  ///< Of those that went.
  };

  [[nodiscard]] double share_in(uint32_t segment, const MemoryId& entity) const;
  void take_from(uint32_t segment, const MemoryId& entity);

  std::vector<Segment> segments_;
  double shares_ = 0;   ///< In segments of which something stays.
  double careful_ = 0;  ///< What is counted on of them.
  uint64_t exact_ = 0;  ///< Of segments that go whole.
};

}  // namespace engram::ltm
