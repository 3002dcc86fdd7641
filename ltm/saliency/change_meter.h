// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how much of a series is told by fewer of its snapshots.

#include <cstdint>
#include <span>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/saliency/moment_content.h"

namespace engram::ltm {

/// A series of one layout: N snapshots with D numbers each, in units of their members.
struct ContentSeries {
  std::vector<ContentMember> members;
  std::vector<Time> times;      ///< N, increasing.
  std::vector<float> numbers;   ///< [N, D]
  std::vector<uint64_t> facts;  ///< N: what cannot be a little different, links included.
  /// N: whether none of its entity lies between it and the one before it.
  std::vector<uint8_t> follows;

  [[nodiscard]] size_t size() const { return times.size(); }
  [[nodiscard]] size_t width() const { return size() == 0 ? 0 : numbers.size() / size(); }
  [[nodiscard]] std::span<const float> row(size_t moment) const {
    return std::span(numbers).subspan(moment * width(), width());
  }
};

/// How far two snapshots of a series are apart: the greatest of its members, each the root of the
/// mean square over its elements; 1 if their facts differ. Unit: member units.
[[nodiscard]] double distance_of(const ContentSeries& series, size_t a, size_t b);
/// The same of numbers alone. Shape: a, b [D].
[[nodiscard]] double distance_of(const std::vector<ContentMember>& members,
                                 std::span<const float> a, std::span<const float> b);

/// How fast the numbers of a series change on the average, pauses left out; at least 0.02. Steps
/// alone count, from one snapshot to the one that follows it. Unit: member units per second.
[[nodiscard]] double pace_of(const ContentSeries& series);

/// How much each snapshot changes what is told of its time. Unit: seconds in which the entity
/// usually changes so much (pace_of). Another text or link counts as 30 s.
///
/// Whoever keeps all snapshots with a change above c, and takes for each other one the last kept
/// one before it, is wrong in no member by more than the entity usually changes in c. The first
/// snapshot has an infinite change.
///
/// Snapshots are left out one by one, always that whose span is told best by the one before it
/// (bottom-up piecewise approximation, by constants). A stretch of a minute that one snapshot tells
/// counts as a second, so still stretches are thinned evenly.
/// Shape: [N]. Complexity: O(N D log N) time; 8 N D bytes of memory beside the series.
/// Source: Keogh et al., An Online Algorithm for Segmenting Time Series (2001), "bottom-up";
/// docs/saliency.md, section "Change".
[[nodiscard]] std::vector<double> measure_change(const ContentSeries& series);

}  // namespace engram::ltm
