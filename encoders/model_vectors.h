// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "ltm/h5/h5.h"

namespace engram::encoders {

/// Largest dataset of a model file that is read.
inline constexpr uint64_t kMaxModelDatasetBytes = uint64_t{1} << 30;

/// How numbers of type T lie in a model file.
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

/// Writes a dataset of one axis.
template <typename T>
Status write_vector(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const uint64_t shape = values.size();
  return file.write(path, kTypeOf<T>, {&shape, 1}, std::as_bytes(std::span(values)),
                    values.empty() ? h5::Storage::kContiguous : h5::Storage::kCompressed);
}

/// Reads one. Errors: kDataLoss where its type is another or it is too large.
template <typename T>
Result<std::vector<T>> read_vector(const h5::File& file, const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file.read(path, kTypeOf<T>, kMaxModelDatasetBytes));
  return h5::as_vector<T>(bytes);
}

}  // namespace engram::encoders
