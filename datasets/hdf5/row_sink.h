// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: who takes the values of one column and makes an array of them.

#include <memory>

#include "datasets/hdf5/columns.h"

namespace engram::datasets {

/// Takes values row by row.
///
/// Errors: kUnavailable naming the file. Threading: one thread.
class RowSink {
 public:
  virtual ~RowSink() = default;

  /// Adds the member of `value` that the column is of.
  /// Errors: kInvalidArgument where it has another shape than the column.
  virtual Status add(const idf::Data& value) = 0;

  /// Writes what waits and closes the array.
  virtual Status finish() = 0;
};

/// Writes the array `path` of `rows` rows by chunks. `file` and `column` must outlive it.
Result<std::unique_ptr<RowSink>> make_column_sink(h5::File& file, const std::string& path,
                                                  const Column& column, uint64_t rows);

/// Whether a column is of images that make_jpeg_sink takes.
[[nodiscard]] bool is_image(const Column& column);

/// Writes images as JPEG files of this quality, each padded with zeros to the longest. They wait in
/// a file beside that one. The sizes of the files are appended to `sizes`, which must outlive it,
/// too.
Result<std::unique_ptr<RowSink>> make_jpeg_sink(h5::File& file, const std::string& path,
                                                const Column& column, int quality,
                                                std::vector<float>& sizes);

}  // namespace engram::datasets
