// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <utility>

#include "ltm/idf/ndarray.h"

namespace engram::idf {

/// A number or an array, converted to another element type.
template <typename T>
struct Converted {
  T value;
  bool is_exact = true;  ///< False where a number was rounded.
};

/// Converts `from` to a To: exactly, or rounded where To is a float. Nothing where To cannot hold
/// it (out of range, or a fraction for an integer). NaN and infinities are kept among floats.
template <typename To, typename From>
[[nodiscard]] std::optional<Converted<To>> convert_number(From from) {
  if constexpr (std::same_as<To, From>) {
    return Converted<To>{from};
  } else if constexpr (std::integral<To> && std::integral<From>) {
    if (!std::in_range<To>(from)) return std::nullopt;
    return Converted<To>{static_cast<To>(from)};
  } else if constexpr (std::integral<To>) {
    // Compares with powers of two, which are exact as floats, unlike the largest integer itself.
    const From low = static_cast<From>(std::numeric_limits<To>::min());
    const From end = std::ldexp(From{1}, std::numeric_limits<To>::digits);
    if (!(from >= low && from < end) || std::trunc(from) != from) return std::nullopt;
    return Converted<To>{static_cast<To>(from)};
  } else if constexpr (std::integral<From>) {
    const To value = static_cast<To>(from);
    const To end = std::ldexp(To{1}, std::numeric_limits<From>::digits);
    return Converted<To>{value, value < end && static_cast<From>(value) == from};
  } else {
    if (!std::isfinite(from)) return Converted<To>{static_cast<To>(from)};
    if (std::abs(from) > static_cast<From>(std::numeric_limits<To>::max())) return std::nullopt;
    const To value = static_cast<To>(from);
    return Converted<To>{value, static_cast<From>(value) == from};
  }
}

/// Converts all elements like convert_number; nothing where one of them cannot be held.
[[nodiscard]] std::optional<Converted<NdArray>> convert_array(const NdArray& array,
                                                              ElementType element);

}  // namespace engram::idf
