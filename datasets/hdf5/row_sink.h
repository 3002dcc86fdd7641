// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: turns the values of one column into an array.

#include <memory>

#include "datasets/hdf5/columns.h"

namespace engram::datasets {

/// Receives values row by row.
///
/// Errors: kUnavailable naming the file. Threading: one thread.
class RowSink {
 public:
  virtual ~RowSink() = default;

  /// Adds the member of `value` that belongs to the column.
  /// Errors: kInvalidArgument if its shape differs from that of the column.
  virtual Status add(const idf::Data& value) = 0;

  /// Writes the remaining rows and closes the array.
  virtual Status finish() = 0;
};

/// Makes a sink that writes the array `path` of `rows` rows in chunks. `file` and `column` must
/// outlive it.
Result<std::unique_ptr<RowSink>> make_column_sink(h5::File& file, const std::string& path,
                                                  const Column& column, uint64_t rows);

/// Returns true if make_jpeg_sink can write the column.
[[nodiscard]] bool is_image(const Column& column);

/// Makes a sink that writes images as JPEG files of this quality, each padded with zeros to the
/// longest one. They are collected in a file beside `file`. The sizes of the JPEG files are
/// appended to `sizes`. All references must outlive the sink.
Result<std::unique_ptr<RowSink>> make_jpeg_sink(h5::File& file, const std::string& path,
                                                const Column& column, int quality,
                                                std::vector<float>& sizes);

}  // namespace engram::datasets
