// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram::speech {

/// How far a hand is open at a moment: the mean of its finger joints, in their own unit, larger
/// where it is more open.
struct HandSample {
  Time time{};
  double open = 0;
};

/// A hand that opened or closed. Indices are those of samples.
struct HandSwing {
  size_t began = 0;   ///< Where it had done a tenth of its way,
  size_t middle = 0;  ///< half,
  size_t ended = 0;   ///< and nine tenths.
  double before = 0;  ///< How far it was open before,
  double after = 0;   ///< and after.

  [[nodiscard]] bool closes() const { return after < before; }
};

/// Something that a hand held: it closed, stayed so, and may have opened again.
struct Grasp {
  HandSwing close;
  HandSwing open;  ///< Only where it let go.
  bool has_let_go = false;
};

/// How a hand swings that cannot be noise or play: a quarter of the way between the ends of its
/// range (2nd and 98th percentiles of `samples`), and eight times the noise of its samples.
/// Infinite where the hand stands still, or does no more than tremble.
[[nodiscard]] double min_swing(std::span<const HandSample> samples);

/// The swings of at least `min_change` between two turns, in the order of time. Slow creeping
/// between two turns belongs to a swing, and is cut off its ends. Complexity: O(samples).
[[nodiscard]] std::vector<HandSwing> hand_swings(std::span<const HandSample> samples,
                                                 double min_change);

/// What was held: the hand closed, and was half open again a second later at the earliest. A hand
/// that closes once more after it let go, and stays so, goes back to rest as long as it did not do
/// so for three seconds.
[[nodiscard]] std::vector<Grasp> grasps_in(std::span<const HandSample> samples, double min_change);

}  // namespace engram::speech
