// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "ltm/likeness/coded_moments.h"
#include "ltm/likeness/similar_moments.h"

namespace engram::ltm {

/// The square of the distance of a moment that may not be answered.
inline constexpr float kNeverNear = std::numeric_limits<float>::infinity();

/// The nearest moments that a request wants, the nearest first; of equally near ones the earlier.
/// `asked` is the moment that was asked with, around which the answer leaves some out; nothing for
/// an image. Shape: squares [N], of the distances of all moments.
/// Complexity: O(N), unless nearly all moments are left out.
[[nodiscard]] std::vector<SimilarMoment> nearest_moments(const CodedMoments& coded,
                                                         std::span<const float> squares,
                                                         const SimilarRequest& request,
                                                         std::optional<size_t> asked);

}  // namespace engram::ltm
