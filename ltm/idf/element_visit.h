// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "ltm/idf/ndarray.h"

namespace engram::idf {

/// Calls `function` with a value of the C++ type of `type`, as in
/// `visit_element_type(type, [&]<typename T>(T) { ... array.values<T>() ... })`.
template <typename F>
auto visit_element_type(ElementType type, F function) {
  switch (type) {
    case ElementType::kInt8:
      return function(int8_t{});
    case ElementType::kInt16:
      return function(int16_t{});
    case ElementType::kInt32:
      return function(int32_t{});
    case ElementType::kInt64:
      return function(int64_t{});
    case ElementType::kUInt8:
      return function(uint8_t{});
    case ElementType::kUInt16:
      return function(uint16_t{});
    case ElementType::kUInt32:
      return function(uint32_t{});
    case ElementType::kUInt64:
      return function(uint64_t{});
    case ElementType::kFloat32:
      return function(float{});
    case ElementType::kFloat64:
      break;
  }
  return function(double{});
}

}  // namespace engram::idf
