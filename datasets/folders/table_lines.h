// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: tables that belong to images.

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "datasets/media/csv_reader.h"
#include "datasets/media/table.h"

namespace engram::datasets {

/// Reads the lines of a table. The cells are separated by commas if the first line has one (RFC
/// 4180), else by blanks. If the first line has a word that is neither a number nor the name of an
/// image, it names the columns; a '#' in front of it is ignored.
///
/// Errors: kInvalidArgument naming file, line, what was found and what was needed. Memory: one
/// line. Threading: one thread.
class TableLines {
 public:
  /// Errors: kNotFound; kInvalidArgument if it is not a file, or is empty.
  static Result<TableLines> open(const std::filesystem::path& path);

  /// Opens a table of words with known columns. A '#' begins a comment in any line, and lines must
  /// not have other columns. Errors: as above, but the table may be empty.
  static Result<TableLines> open(const std::filesystem::path& path, std::vector<std::string> names);

  /// The name of each column, or "column 1" if it has none.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has_names() const { return has_names_; }

  /// Advances to the next line; returns false after the last one.
  Result<bool> next();

  [[nodiscard]] const std::string& cell(size_t column) const { return cells_[column]; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Errors: if the cell is not a number.
  Result<double> number(size_t column) const;
  /// Errors: if the cell is not a time.
  Result<Time> time(size_t column, TimeUnit unit) const;

  /// Makes the error "'data.csv': line 3, column 'x': found 'y', <what>".
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
  std::ifstream words_;  ///< Used if there is no `csv_`.
  uint64_t line_ = 0;
  std::vector<std::string> names_;
  bool has_names_ = false;
  std::vector<std::string> cells_;
  bool is_known_ = false;   ///< The columns are known before anything is read.
  bool has_first_ = false;  ///< The first line was read to find out whether it names columns.
};

/// Returns true if the whole text is a number.
[[nodiscard]] bool is_number(std::string_view text);

}  // namespace engram::datasets
