// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "ltm/h5/h5.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// A dataset of a segment file, read in windows of rows, so that neighbouring rows cost one read
/// and memory stays bounded. A window is one chunk of the dataset. The windows used last are kept.
///
/// Threading: one thread. The file must outlive it.
class SegmentColumn {
 public:
  /// Errors: kNotFound, kDataLoss.
  static Result<SegmentColumn> open(const h5::File& file, const std::string& path);

  [[nodiscard]] uint64_t rows() const { return info_.shape.empty() ? 0 : info_.shape[0]; }
  [[nodiscard]] const h5::DatasetInfo& info() const { return info_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// The bytes of one row, valid until the next call.
  /// Errors: kDataLoss if the row does not exist or its chunk is damaged.
  Result<std::span<const std::byte>> row(uint64_t index);

  /// One number of a 1-D column.
  /// Errors: kDataLoss, also if the column has a different element type.
  template <typename T>
  Result<T> number(uint64_t index);

 private:
  struct Window {
    uint64_t first = 0;
    uint64_t last_use = 0;
    std::vector<std::byte> bytes;
  };

  SegmentColumn(const h5::File& file, std::string path, h5::DatasetInfo info);

  Result<const Window*> window_of(uint64_t index);

  const h5::File* file_;
  std::string path_;
  h5::DatasetInfo info_;
  uint64_t row_bytes_ = 0;
  uint64_t window_rows_ = 1;
  size_t max_windows_ = 1;
  uint64_t uses_ = 0;
  std::vector<Window> windows_;
};

/// The HDF5 type of a dataset with elements of `type`.
[[nodiscard]] h5::Type h5_type(idf::ElementType type);

template <typename T>
Result<T> SegmentColumn::number(uint64_t index) {
  if (info_.type != h5_type(idf::kElementTypeOf<T>))
    return data_loss("'{}' has another element type than needed", path_);
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, row(index));
  if (bytes.size() != sizeof(T)) return data_loss("'{}' is no column of numbers", path_);
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

}  // namespace engram::ltm
