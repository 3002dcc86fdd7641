// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how far a snapshot is from all that came before it.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "ltm/saliency/change_meter.h"

namespace engram::ltm {

/// Remembers what an entity had, in at most 256 examples, and says how far each snapshot is from
/// the nearest of them.
///
/// A snapshot becomes an example if it is farther than a radius from all others. Where there are
/// too many, the radius grows, and those within it of an earlier one are dropped. So what it says
/// is wrong by at most the radius, which few snapshots come close to.
/// Threading: one thread.
/// Complexity: O(256 D) for each snapshot.
/// Source: the doubling algorithm for incremental clustering, Charikar et al. 1997;
/// docs/saliency.md, section "Novelty".
class NoveltyMeter {
 public:
  static constexpr size_t kMaxExamples = 256;
  /// Texts that are counted; what comes later than that many others counts as known.
  static constexpr size_t kMaxTexts = size_t{1} << 16;

  explicit NoveltyMeter(std::vector<ContentMember> members) : members_(std::move(members)) {}

  /// The novelty of a snapshot, 0 to 1: its distance from the nearest example in units, 1 at most;
  /// or, if that is more, one over how often its texts came, this time included. Then learns it.
  double next(const ContentSeries& series, size_t at);

 private:
  void learn(std::span<const float> row, double distance);
  void thin();

  std::vector<ContentMember> members_;
  std::vector<std::vector<float>> examples_;
  double radius_ = 0.01;
  std::unordered_map<uint64_t, uint64_t> texts_;
};

}  // namespace engram::ltm
