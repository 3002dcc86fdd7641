// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: tables that lie beside images.

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "datasets/media/csv_reader.h"
#include "datasets/media/table.h"

namespace engram::datasets {

/// Reads the lines of a table: cells between commas where its first line has one (RFC 4180), else
/// words between blanks. A first line that has a word which is neither a number nor the name of an
/// image names the columns; a '#' in front of it is left out.
///
/// Errors: kInvalidArgument naming file, line, what was found and what was needed. Memory: one
/// line. Threading: one thread.
class TableLines {
 public:
  /// Errors: kNotFound; kInvalidArgument where it is no file, or empty.
  static Result<TableLines> open(const std::filesystem::path& path);

  /// One of words whose columns are known: a '#' begins a comment in any line, and there may be no
  /// others. Errors: as above, but not where it is empty.
  static Result<TableLines> open(const std::filesystem::path& path, std::vector<std::string> names);

  /// One for each column: its name, else "column 1".
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has_names() const { return has_names_; }

  /// Goes to the next line; false behind the last.
  Result<bool> next();

  [[nodiscard]] const std::string& cell(size_t column) const { return cells_[column]; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Errors: where a cell is no number.
  Result<double> number(size_t column) const;
  /// Errors: where a cell is no time.
  Result<Time> time(size_t column, TimeUnit unit) const;

  /// "'data.csv': line 3, column 'x': found 'y', <what>".
  [[nodiscard]] Status broken(size_t column, std::string_view what) const;

 private:
  TableLines(std::filesystem::path path, std::ifstream words)
      : path_(std::move(path)), words_(std::move(words)) {}

  static Result<TableLines> open_words(const std::filesystem::path& path);

  Result<bool> next_cells();
  Result<bool> next_words();
  [[nodiscard]] uint64_t line() const { return csv_ ? csv_->line() : line_; }

  std::filesystem::path path_;
  std::optional<CsvReader> csv_;
  std::ifstream words_;  ///< Where there is no `csv_`.
  uint64_t line_ = 0;
  std::vector<std::string> names_;
  bool has_names_ = false;
  std::vector<std::string> cells_;
  bool is_known_ = false;   ///< What the columns are, before anything is read.
  bool has_first_ = false;  ///< The first line was read to see whether it names columns.
};

/// Whether all of a text is a number.
[[nodiscard]] bool is_number(std::string_view text);

}  // namespace engram::datasets
