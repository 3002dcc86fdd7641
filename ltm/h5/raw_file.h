// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: the bytes of a file below HDF5.

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <vector>

#include "ltm/core/file.h"
#include "ltm/core/status.h"

namespace engram::h5 {

using RawBytes = std::vector<std::byte>;
using RawView = std::span<const std::byte>;

/// Reads at HDF5 offsets.
///
/// Errors: kDataLoss naming the offset, the announced size and the size of the file.
/// Threading: const-parallel.
class RawFile {
 public:
  /// `base` is the start of the HDF5 content, after any user block.
  static Result<RawFile> open(const std::filesystem::path& path, uint64_t base);

  [[nodiscard]] Result<RawBytes> read(uint64_t offset, uint64_t size) const;

 private:
  RawFile(engram::File file, uint64_t base, uint64_t size)
      : file_(std::move(file)), base_(base), size_(size) {}

  engram::File file_;
  uint64_t base_ = 0;
  uint64_t size_ = 0;
};

/// The little-endian number at `at`. The bytes must exist.
template <typename T>
[[nodiscard]] T raw_number(RawView bytes, size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// `size`, rounded up to a multiple of 8.
[[nodiscard]] inline uint64_t padded_size(uint64_t size) {
  return (size + 7) / 8 * 8;
}

}  // namespace engram::h5
