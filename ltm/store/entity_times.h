// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram::ltm {

/// Equal parts of a span of time. Part `i` begins at begin(i) and ends before begin(i + 1).
///
/// Threading: immutable.
class TimeBins {
 public:
  /// The bound of parts: more than a screen is wide.
  static constexpr size_t kMaxCount = 1 << 16;

  /// Errors: kInvalidArgument if `last` is not after `first`, or unless 1 <= count <= kMaxCount.
  static Result<TimeBins> create(Time first, Time last, size_t count);

  [[nodiscard]] size_t count() const { return count_; }

  /// Exact for any span that times can have. Needs i <= count() (checked).
  [[nodiscard]] Time begin(size_t i) const;

 private:
  TimeBins(Time first, uint64_t span_ns, size_t count)
      : first_(first), span_ns_(span_ns), count_(count) {}

  Time first_;
  uint64_t span_ns_;
  size_t count_;
};

/// How many snapshots lie in a part of a span. Each counts once.
struct FormCounts {
  uint32_t recorded = 0;   ///< In recorded form alone.
  uint32_t latent = 0;     ///< With latents, whether or not the recorded form is still there.
  uint32_t augmented = 0;  ///< Deliberately changed, without latents.

  friend bool operator==(const FormCounts&, const FormCounts&) = default;
};

/// The times of all snapshots of an entity, in one generation of a store. They are 8 bytes each, so
/// that a screen of lanes is counted by binary searches in memory.
///
/// Threading: const-parallel.
struct EntityTimes {
  // Sorted, each time once.
  std::vector<Time> all;
  std::vector<Time> latent;  ///< Of snapshots with latents that are not superseded.
  /// Of augmented snapshots. A segment that has augmented and other snapshots of the entity is
  /// counted as recorded, and so are journals, because times do not tell which is which.
  std::vector<Time> augmented;

  /// Adds what a later segment or the journals have. `times` are sorted, each time once. A recorded
  /// form that is later than latents supersedes them (SnapshotEntry::put).
  /// Complexity: O(times), if they lie after all others; else O(all).
  void add(std::span<const Time> times, bool is_latent, bool is_augmented);

  [[nodiscard]] size_t size_bytes() const {
    return (all.size() + latent.size() + augmented.size()) * sizeof(Time);
  }

  /// Complexity: O(bins * log(snapshots)).
  [[nodiscard]] std::vector<FormCounts> count_in(const TimeBins& bins) const;
};

}  // namespace engram::ltm
