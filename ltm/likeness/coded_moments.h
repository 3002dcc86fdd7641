// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/sequences.h"
#include "ltm/likeness/likeness_space.h"
#include "ltm/recall/store_past.h"

namespace engram::ltm {

/// What the codes of an entity are made of.
enum class CodedBy {
  kImages,   ///< Of its images, in a space.
  kNumbers,  ///< Of its numbers: their standardised values, and their changes in 0.4 s.
};

/// The codes of all moments of one entity that have one: N of them, with K numbers each.
struct CodedMoments {
  CodedBy coded_by = CodedBy::kImages;
  LikenessSpace space;           ///< Of images.
  bool is_stored_space = false;  ///< It is kept with the store. Otherwise it was learned just now.
  std::vector<Time> times;       ///< N, increasing.
  size_t numbers = 0;            ///< K.
  std::vector<float> codes;      ///< [N, K]
  std::vector<Sequence> recordings;  ///< Cover all N.
  uint64_t computed = 0;             ///< Codes that were not stored, so that images were decoded.

  [[nodiscard]] size_t size() const { return times.size(); }
  [[nodiscard]] std::span<const float> code(size_t moment) const {
    return std::span(codes).subspan(moment * numbers, numbers);
  }

  /// The last moment at or before a time; nothing if all are later.
  [[nodiscard]] std::optional<size_t> at_or_before(Time time) const;

  /// For each moment the one that was `lag` before it in the same recording, or the first of its
  /// recording. Shape: [N].
  [[nodiscard]] std::vector<size_t> lagged(Duration lag) const;

  /// The distance of two moments at random, per number: the unit of distances.
  [[nodiscard]] double spread() const;

  /// The squares of the distances of all moments from one of them, with what came before each,
  /// 0.2, 0.6, 1 and 2 s before for a context of 2 s. 1: as far as two at random. Shape: [N].
  /// Complexity: O(N K), five times with a context.
  [[nodiscard]] std::vector<double> square_distances(size_t moment, Duration context) const;
  /// The same from a code of this space, without what came before. Shape: code [K].
  [[nodiscard]] std::vector<double> square_distances(std::span<const float> code) const;
};

/// Codes of images come from the indexes of segments, and are computed where they are not stored;
/// without a stored space one is learned. Numbers are read: that takes no longer than reading codes
/// of them would. Of more than 100,000 moments with numbers an even part is taken.
/// Errors: kNotFound if there is no such entity; kFailedPrecondition if it has neither images nor
/// numbers, or too few; kCancelled on `stop`; those of reading.
Result<CodedMoments> code_moments(StorePast& past, const MemoryId& entity,
                                  const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::ltm
