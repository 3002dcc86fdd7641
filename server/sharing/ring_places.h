// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace engram::server {

/// The bit of an entity of a ring, by its place.
constexpr uint64_t bit_of_place(size_t place) {
  return uint64_t{1} << place;
}

/// Calls `visit` with the place of each bit, the lowest first.
template <typename Visit>
void for_each_place(uint64_t bits, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<size_t>(std::countr_zero(bits)));
}

}  // namespace engram::server
