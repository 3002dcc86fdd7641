// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ltm/core/time.h"

namespace engram::ltm {

// Of ltm/likeness/coded_moments.h, which who has a map need not read.
enum class CodedBy;
struct CodedMoments;

/// Moments of an entity in two dimensions: those that are like each other are near.
struct MomentMap {
  std::string space;                 ///< Of the codes: "images 8c21fe03", "numbers".
  CodedBy coded_by{};                ///< Images, unless it is set.
  uint64_t known = 0;                ///< Moments that have codes.
  std::vector<Time> times;           ///< M of them, evenly spread, increasing.
  std::vector<float> x, y;           ///< [M]. Unit: the distance of two moments at random.
  std::vector<uint32_t> recordings;  ///< [M], which recording each is of, from 0 on.
  /// The share of the variance of the codes that the two dimensions have. The rest is not seen:
  /// what is near here need not be alike, but what is far differs.
  double explained = 0;
};

/// The two principal components of the codes of at most `max_moments` moments. Larger values of x
/// and y are those towards which the codes have the larger third moment, so that a map does not
/// turn round when moments are added. Complexity: O(M K).
[[nodiscard]] MomentMap map_of(const CodedMoments& coded, size_t max_moments);

}  // namespace engram::ltm
