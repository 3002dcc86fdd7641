// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace engram::training {

/// How quick networks train on this machine, now. Unit: steps per second.
struct ParallelSpeed {
  double one_of_two = 0;  ///< One training with two threads.
  double two_of_one = 0;  ///< Two trainings at once with one thread each, added up.
};

/// Trains small networks for about a second, both ways in turn.
/// Threading: leaves the networks' threads of this process at one.
[[nodiscard]] ParallelSpeed measure_parallel_speed();

/// Two groups of about the same weight, by index: the heavier one first. Shape: weights not
/// negative.
[[nodiscard]] std::vector<std::vector<size_t>> split_in_two(std::span<const double> weights);

/// Whether entities of these shares of the work (their sum is 1) are done sooner in two processes
/// of one thread, each with one of the groups, than one after another with two threads.
[[nodiscard]] bool two_are_quicker(std::span<const double> shares, const ParallelSpeed& speed);

}  // namespace engram::training
