// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "ltm/h5/h5.h"

namespace engram::encoders {

/// Maximum size of a dataset that is read from a model file.
inline constexpr uint64_t kMaxModelDatasetBytes = uint64_t{1} << 30;

/// The type in a model file of numbers of type T.
template <typename T>
inline constexpr h5::Type kTypeOf = [] {
  if constexpr (std::is_same_v<T, int8_t>)
    return h5::Type::kInt8;
  else if constexpr (std::is_same_v<T, uint8_t>)
    return h5::Type::kUInt8;
  else if constexpr (std::is_same_v<T, uint16_t>)
    return h5::Type::kUInt16;
  else if constexpr (std::is_same_v<T, int32_t>)
    return h5::Type::kInt32;
  else if constexpr (std::is_same_v<T, int64_t>)
    return h5::Type::kInt64;
  else if constexpr (std::is_same_v<T, float>)
    return h5::Type::kFloat32;
  else {
    static_assert(std::is_same_v<T, double>);
    return h5::Type::kFloat64;
  }
}();

/// Writes a dataset with one axis.
template <typename T>
Status write_vector(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const uint64_t shape = values.size();
  return file.write(path, kTypeOf<T>, {&shape, 1}, std::as_bytes(std::span(values)),
                    values.empty() ? h5::Storage::kContiguous : h5::Storage::kCompressed);
}

/// Reads a dataset with one axis.
/// Errors: kDataLoss if it has another type or is too large.
template <typename T>
Result<std::vector<T>> read_vector(const h5::File& file, const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file.read(path, kTypeOf<T>, kMaxModelDatasetBytes));
  return h5::as_vector<T>(bytes);
}

}  // namespace engram::encoders
