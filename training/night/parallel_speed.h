// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace engram::training {

/// Current speed of training on this machine. Unit: steps per second.
struct ParallelSpeed {
  double one_of_two = 0;  ///< One training with two threads.
  double two_of_one = 0;  ///< Sum of two trainings at once with one thread each.
};

/// Trains small networks for about a second, alternating between both ways.
/// Threading: it sets the threads of the networks in this process to one.
[[nodiscard]] ParallelSpeed measure_parallel_speed();

/// Splits indices into two groups of about the same weight, the heavier one first. Weights must not
/// be negative.
[[nodiscard]] std::vector<std::vector<size_t>> split_in_two(std::span<const double> weights);

/// Whether two processes of one thread, each with one of the groups, finish entities with these
/// shares of the work (with a sum of 1) sooner than one process with two threads.
[[nodiscard]] bool two_are_quicker(std::span<const double> shares, const ParallelSpeed& speed);

}  // namespace engram::training
