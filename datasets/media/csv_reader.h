// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::datasets {

/// Reads the records of a comma-separated file one by one.
///
/// Cells may be quoted; quoted cells may contain commas, line breaks and doubled quotes. Lines end
/// in LF or CRLF. Empty lines and a UTF-8 byte order mark are skipped.
/// Threading: one thread. Memory: one record.
/// Source: RFC 4180.
class CsvReader {
 public:
  /// Errors: kNotFound; kInvalidArgument if it is not a file; kUnavailable.
  static Result<CsvReader> open(const std::filesystem::path& path);

  /// Replaces `cells` by the next record; returns false after the last one.
  /// Errors: kInvalidArgument naming file and line if quotes do not match or a cell exceeds 1 MiB;
  /// kUnavailable if the disk fails.
  Result<bool> next(std::vector<std::string>& cells);

  /// The line on which the last record began, starting from 1.
  [[nodiscard]] uint64_t line() const { return record_line_; }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  CsvReader(std::filesystem::path path, std::ifstream file);

  /// Returns the next byte, or -1 at the end.
  int get();
  int peek();
  void fill();
  void skip_mark();
  bool takes_line_end(int byte);
  bool skip_empty_lines();
  Status read_cell(std::string& cell);
  Status read_quoted(std::string& cell);
  [[nodiscard]] Status broken(uint64_t line, std::string_view what) const;

  std::filesystem::path path_;
  std::ifstream file_;
  std::vector<char> buffer_;
  size_t at_ = 0;
  size_t end_ = 0;
  uint64_t line_ = 1;
  uint64_t record_line_ = 0;
};

}  // namespace engram::datasets
