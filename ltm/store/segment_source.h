// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what segment files are read with.

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/store/segment_column.h"

namespace engram::ltm {

/// An open segment file: its datasets and blobs, each opened once. Safe on hostile files.
///
/// Errors: kDataLoss naming file, object and row, everywhere.
/// Threading: one thread. What it gave back is valid as long as it, rows until the next call.
class SegmentSource {
 public:
  SegmentSource(h5::File file, File raw) : file_(std::move(file)), raw_(std::move(raw)) {}
  /// Columns refer to it.
  SegmentSource(const SegmentSource&) = delete;
  SegmentSource& operator=(const SegmentSource&) = delete;

  [[nodiscard]] const h5::File& file() const { return file_; }
  [[nodiscard]] Result<uint64_t> size_bytes() const { return raw_.size(); }

  [[nodiscard]] Status broken(const std::string& object, std::string_view what) const;

  /// Puts the file's name before an error.
  template <typename T>
  [[nodiscard]] Result<T> located(Result<T> result) const {
    if (result.ok()) return result;
    return result.status().with_context(fmt::format("segment '{}'", raw_.path().string()));
  }

  Result<SegmentColumn*> column(const std::string& path);
  /// Null where the file has no such dataset.
  Result<SegmentColumn*> column_if_there(const std::string& path);

  template <typename T>
  Result<T> number(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column(path));
    return located(values->number<T>(row));
  }

  /// A number per row of the entity, where one row stands for all if they are equal.
  template <typename T>
  Result<T> row_number(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column(path));
    return located(values->number<T>(values->rows() == 1 ? 0 : row));
  }

  Result<const std::vector<std::string>*> strings(const std::string& path);

  /// Blob `index` of a blob column, read at its offset without HDF5. Empty where it has no bytes.
  Result<Buffer> blob(const std::string& group, uint64_t index);

 private:
  h5::File file_;
  File raw_;  ///< The same file, for blobs at their offsets.
  std::map<std::string, std::optional<SegmentColumn>> columns_;  ///< Nothing: not there.
  std::map<std::string, std::vector<std::string>> string_lists_;
};

}  // namespace engram::ltm
