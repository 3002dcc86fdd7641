// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: tables, read row by row.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "datasets/media/csv_reader.h"
#include "ltm/core/time.h"

namespace engram::datasets::lerobot {

/// A folder that is removed together with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// Empty if no folder could be made.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Reads the rows of a table one after the other.
///
/// Errors: kInvalidArgument naming table, row, column, what was found and what was needed.
/// Memory: one row. Threading: one thread.
class RowTable {
 public:
  /// Opens the table `parquet` in the folder `root`. If there is a CSV of the same name beside it
  /// (or in `root`/tables if `looks_in_tables` is true), that is read. Else the table is read
  /// through pyarrow, which needs room for it as CSV in the temporary folder.
  /// Errors: kNotFound if there is neither; kFailedPrecondition if Python has no pyarrow, saying
  /// what to do.
  static Result<RowTable> open(const std::filesystem::path& root,
                               const std::filesystem::path& parquet, bool looks_in_tables);

  /// Opens a CSV that names images relative to `root`.
  static Result<RowTable> open_csv(const std::filesystem::path& root,
                                   const std::filesystem::path& csv);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  /// Returns the column that has one of these names.
  [[nodiscard]] std::optional<size_t> find(const std::vector<std::string>& names) const;
  /// Errors: kInvalidArgument if there is no such column.
  Result<size_t> need(const std::string& name) const;

  /// Advances to the next row; returns false after the last one.
  Result<bool> next();

  /// The number of the row, starting from 1.
  [[nodiscard]] uint64_t row() const { return row_; }
  [[nodiscard]] const std::string& text(size_t column) const { return cells_[column]; }

  /// Returns nothing if the cell is empty. Errors: if it is not a number.
  Result<std::optional<double>> number(size_t column) const;
  /// Returns nothing if the cell is empty. Errors: if it is not a whole number of 64 bits.
  Result<std::optional<int64_t>> integer(size_t column) const;
  /// Errors: if the cell is not a whole number of 0 or more.
  Result<int64_t> whole(size_t column) const;
  /// Reads seconds exactly. Errors: if they are not in 0 to 1e8.
  Result<Duration> seconds(size_t column) const;
  /// Returns the file that a cell names.
  Result<std::filesystem::path> file(size_t column) const;

  /// Makes the error "'data/file-000.csv': row 3, column 'timestamp': <what>".
  [[nodiscard]] Status broken(size_t column, std::string_view what) const;

 private:
  RowTable(std::filesystem::path root, std::string title, CsvReader csv)
      : root_(std::move(root)), title_(std::move(title)), csv_(std::move(csv)) {}

  static Result<RowTable> create(std::filesystem::path root, std::string title,
                                 const std::filesystem::path& csv);

  std::filesystem::path root_;  ///< The folder that names of images are relative to.
  std::string title_;
  CsvReader csv_;
  std::unique_ptr<TemporaryFolder> folder_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, size_t> columns_;  ///< The first column of each name.
  std::vector<std::string> cells_;
  uint64_t row_ = 0;
};

/// Returns where a table is as CSV: beside the Parquet file or, if `looks_in_tables` is true, in
/// `root`/tables. Empty if there is no CSV.
[[nodiscard]] std::filesystem::path csv_of(const std::filesystem::path& root,
                                           const std::filesystem::path& parquet,
                                           bool looks_in_tables);

}  // namespace engram::datasets::lerobot
