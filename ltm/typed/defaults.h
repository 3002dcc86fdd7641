// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "ltm/core/check.h"
#include "ltm/idf/ndarray.h"

// Initial values of the members of generated structs.
namespace engram::typed {

/// An array of this shape whose elements are all `value`. Needs sizes that are not negative and fit
/// into memory (checked).
template <typename T>
[[nodiscard]] idf::NdArray filled(idf::Shape shape, T value = T{}) {
  const auto bytes = idf::size_bytes(idf::kElementTypeOf<T>, shape);
  ENGRAM_CHECK(bytes.has_value(), "an array of shape {} is too large", idf::to_string(shape));
  return idf::NdArray::take<T>(std::move(shape), std::vector<T>(*bytes / sizeof(T), value));
}

template <size_t kSize, typename T>
[[nodiscard]] std::array<T, kSize> repeated(const T& value) {
  return [&]<size_t... i>(std::index_sequence<i...>) {
    return std::array<T, kSize>{((void)i, value)...};
  }
  (std::make_index_sequence<kSize>());
}

}  // namespace engram::typed
