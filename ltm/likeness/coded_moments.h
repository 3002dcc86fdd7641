// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/core/sequences.h"
#include "ltm/likeness/likeness_space.h"
#include "ltm/memory/sight.h"

namespace engram::ltm {

/// What the codes of an entity are made of.
enum class CodedBy {
  kImages,   ///< Of its images, in a space.
  kNumbers,  ///< Of its numbers: their standardised values, and their changes in 0.4 s.
};

/// How far back the changes of numbers reach.
inline constexpr Duration kChangeLag = std::chrono::milliseconds(400);

/// The codes of moments of one entity: N of them, with K numbers each.
///
/// Threading: immutable, const-parallel.
struct CodedMoments {
  CodedBy coded_by = CodedBy::kImages;
  LikenessSpace space;           ///< Of images.
  bool is_stored_space = false;  ///< It is kept with the store. Otherwise it was learned just now.
  std::vector<Time> times;       ///< N, increasing.
  size_t numbers = 0;            ///< K.
  std::vector<int8_t> bytes;     ///< [N, K], of images.
  std::vector<float> floats;     ///< [N, K], of numbers.
  std::vector<Sequence> recordings;  ///< Cover all N.
  double spread = 0;  ///< The distance of two moments at random, per number: the unit of distances.

  [[nodiscard]] size_t size() const { return times.size(); }

  /// What people see of the space: "images 8c21fe03", "numbers".
  [[nodiscard]] std::string space_name() const {
    return coded_by == CodedBy::kNumbers ? "numbers" : "images " + space.name();
  }

  /// The last moment at or before a time; nothing if all are later.
  [[nodiscard]] std::optional<size_t> at_or_before(Time time) const;

  /// The index of the recording that a moment is in.
  /// Complexity: O(log recordings).
  [[nodiscard]] size_t recording_of(size_t moment) const;

  /// The moment that was `lag` before another one in the same recording, or the first of it.
  [[nodiscard]] size_t before(size_t moment, Duration lag) const;

  /// Finds the recordings and the spread. Call it once all moments are there.
  /// Complexity: O(N K).
  void finish();

  /// The same once more moments are behind the first `finished`, for which it was called. Of more
  /// than 200,000 moments the spread stays, and recordings are cut by the steps of the last of
  /// them. Complexity: O(moments behind `finished`), and of 200,000.
  void finish_from(size_t finished);

  /// Takes away all moments behind the first `count`.
  void truncate(size_t count);

  /// The squares of the distances of all moments from one of them, with what came before each,
  /// 0.2, 0.6, 1 and 2 s before for a context of 2 s. 1: as far as two at random. Shape: [N].
  /// Complexity: O(N K), five times with a context.
  [[nodiscard]] std::vector<float> square_distances(size_t moment, Duration context) const;
  /// The same from a code of this space, without what came before. Needs codes of images (checked).
  /// Shape: code [K].
  [[nodiscard]] std::vector<float> square_distances(std::span<const int8_t> code) const;

  /// The moments at some times alone, as if there were no others: recordings and spread are theirs.
  /// Changes of numbers reach back: moments whose changes began at another time are left out.
  [[nodiscard]] CodedMoments only(const TimeWindows& at) const;
};

}  // namespace engram::ltm
