// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment reader.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/store/segment_column.h"

namespace engram::ltm {

/// An open segment file. Each of its datasets and blobs is opened once. Safe on hostile files.
///
/// Errors: all functions return kDataLoss naming file, object and row.
/// Threading: one thread. Results are valid as long as this object, rows until the next call.
class SegmentSource {
 public:
  SegmentSource(h5::File file, File raw) : file_(std::move(file)), raw_(std::move(raw)) {}
  /// Not copyable, because columns refer to it.
  SegmentSource(const SegmentSource&) = delete;
  SegmentSource& operator=(const SegmentSource&) = delete;

  [[nodiscard]] const h5::File& file() const { return file_; }
  [[nodiscard]] Result<uint64_t> size_bytes() const { return raw_.size(); }

  [[nodiscard]] Status broken(const std::string& object, std::string_view what) const;

  /// Adds the file's name to an error.
  template <typename T>
  [[nodiscard]] Result<T> located(Result<T> result) const {
    if (result.ok()) return result;
    return result.status().with_context(fmt::format("segment '{}'", raw_.path().string()));
  }

  Result<SegmentColumn*> column(const std::string& path);
  /// The column at `path`, or null if the file has no such dataset.
  Result<SegmentColumn*> column_if_there(const std::string& path);

  template <typename T>
  Result<T> number(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column(path));
    return located(values->number<T>(row));
  }

  /// One number of a row. A column of one row holds the number of all rows.
  template <typename T>
  Result<T> row_number(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column(path));
    return row_number<T>(*values, row);
  }
  template <typename T>
  Result<T> row_number(SegmentColumn& values, uint64_t row) {
    return located(values.number<T>(values.rows() == 1 ? 0 : row));
  }

  Result<const std::vector<std::string>*> strings(const std::string& path);

  /// Reads blob `index` of a blob column at its offset, without HDF5. Empty if the blob has no
  /// bytes.
  Result<Buffer> blob(const std::string& group, uint64_t index);

 private:
  h5::File file_;
  File raw_;  ///< The same file, for blobs at their offsets.
  /// nullopt: the dataset does not exist.
  std::unordered_map<std::string, std::optional<SegmentColumn>> columns_;
  std::unordered_map<std::string, std::vector<std::string>> string_lists_;
};

}  // namespace engram::ltm
