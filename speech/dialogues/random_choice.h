// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: one of several by chance.

#include <cstddef>
#include <iterator>
#include <random>

namespace engram::speech::dialogues {

/// A number from 0 on, below `count`, which must not be 0.
[[nodiscard]] inline size_t below(size_t count, std::mt19937_64& random) {
  return static_cast<size_t>(random() % count);
}

/// Where one of them is; there must be one.
template <typename All>
[[nodiscard]] auto one_of(All& all, std::mt19937_64& random) {
  return std::next(all.begin(), static_cast<std::ptrdiff_t>(below(all.size(), random)));
}

}  // namespace engram::speech::dialogues
