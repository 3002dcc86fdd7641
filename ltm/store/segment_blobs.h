// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer.

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "ltm/h5/h5.h"
#include "ltm/idf/data.h"
#include "ltm/store/segment_column.h"

namespace engram::ltm {

/// Writes a 1-D packed dataset.
template <typename T>
Status write_column(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const uint64_t count = values.size();
  return file.write(path, h5_type(idf::kElementTypeOf<T>), {&count, 1},
                    std::as_bytes(std::span(values)), h5::Storage::kCompressed);
}

/// Writes one number per row of an entity. If all are equal, only one is stored.
template <typename T>
Status write_row_column(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const auto differs = [&](const T& value) {
    return std::memcmp(&value, values.data(), sizeof(T)) != 0;
  };
  if (values.size() > 1 && std::ranges::none_of(values, differs))
    return write_column(file, path, std::vector<T>{values.front()});
  return write_column(file, path, values);
}

/// A column of byte strings of varying length, one per row or block of rows.
///
/// Source: docs/format.md, "Blobs".
class BlobColumn {
 public:
  void append(std::span<const std::byte> blob);

  [[nodiscard]] uint64_t size_bytes() const { return bytes_.size(); }

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

 private:
  std::vector<std::byte> bytes_;
  std::vector<uint64_t> offsets_{0};
  std::vector<uint64_t> checksums_;
};

/// A column of remainders, packed in blocks of rows so that similar strings cost little. Many small
/// blocks share a dictionary if that takes fewer bytes in total.
///
/// Source: docs/format.md, "Remainder".
class RemainderColumn {
 public:
  void append(idf::Data row);

  /// Writes the column. May be called only once. Errors: those of h5::File::write and idf::encode.
  Status write(h5::File& file, const std::string& group);

 private:
  Result<std::vector<Buffer>> take_blocks(size_t rows_per_block);

  idf::List rows_;
  size_t largest_bytes_ = 0;
};

}  // namespace engram::ltm
