// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

#include "ltm/idf/type.h"

namespace engram::idf {

/// True where `value` is within the bounds; exact for every type, including 64-bit integers.
template <typename T>
[[nodiscard]] bool is_within(const Quantity& quantity, T value) {
  if (!quantity.is_bounded()) return true;
  if constexpr (std::floating_point<T>)
    if (!std::isfinite(value)) return false;
  using Wide = std::conditional_t<std::integral<T> && sizeof(T) == 8, long double, double>;
  const Wide wide = static_cast<Wide>(value);
  return !(quantity.minimum && wide < static_cast<Wide>(*quantity.minimum)) &&
         !(quantity.maximum && wide > static_cast<Wide>(*quantity.maximum));
}

/// The T within the bounds that is closest to zero; nothing where no T is within the bounds.
template <typename T>
[[nodiscard]] std::optional<T> closest_to_zero(const Quantity& quantity) {
  if (is_within(quantity, T{})) return T{};
  const bool is_above = quantity.minimum && *quantity.minimum > 0;
  if (!is_above && !quantity.maximum) return std::nullopt;
  const double bound = is_above ? *quantity.minimum : *quantity.maximum;
  T value{};
  if constexpr (std::floating_point<T>) {
    if (std::abs(bound) > static_cast<double>(std::numeric_limits<T>::max())) return std::nullopt;
    value = static_cast<T>(bound);
    if (!is_within(quantity, value))
      value = std::nextafter(value, is_above ? std::numeric_limits<T>::infinity()
                                             : -std::numeric_limits<T>::infinity());
  } else {
    const long double whole = is_above ? std::ceil(bound) : std::floor(bound);
    if (whole > static_cast<long double>(std::numeric_limits<T>::max()) ||
        whole < static_cast<long double>(std::numeric_limits<T>::min()))
      return std::nullopt;
    value = static_cast<T>(whole);
  }
  return is_within(quantity, value) ? std::optional(value) : std::nullopt;
}

}  // namespace engram::idf
