// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: tables, row by row.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "datasets/media/csv_reader.h"
#include "ltm/core/time.h"

namespace engram::datasets::lerobot {

/// A folder that goes with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// Empty where none could be made.
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
  /// The table in the folder `root` that is called `parquet`: from the CSV beside it, of the same
  /// name, where there is one (or in `root`/tables where `looks_in_tables`), else through pyarrow,
  /// which needs room for it as CSV in the temporary folder.
  /// Errors: kNotFound where there is neither; kFailedPrecondition where Python has no pyarrow,
  /// saying what to do.
  static Result<RowTable> open(const std::filesystem::path& root,
                               const std::filesystem::path& parquet, bool looks_in_tables);

  /// A CSV whose images are named as in `root`.
  static Result<RowTable> open_csv(const std::filesystem::path& root,
                                   const std::filesystem::path& csv);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  /// The column of one of these names.
  [[nodiscard]] std::optional<size_t> find(const std::vector<std::string>& names) const;
  /// Errors: kInvalidArgument where there is none.
  Result<size_t> need(const std::string& name) const;

  /// Goes to the next row; false behind the last.
  Result<bool> next();

  /// Of the row: from 1 on.
  [[nodiscard]] uint64_t row() const { return row_; }
  [[nodiscard]] const std::string& text(size_t column) const { return cells_[column]; }

  /// Nothing where the cell is empty. Errors: where it is no number.
  Result<std::optional<double>> number(size_t column) const;
  /// Nothing where the cell is empty. Errors: where it is no whole number of 64 bits.
  Result<std::optional<int64_t>> integer(size_t column) const;
  /// Errors: where it is no whole number of 0 or more.
  Result<int64_t> whole(size_t column) const;
  /// Seconds, read exactly. Errors: where it is not 0 to 1e8.
  Result<Duration> seconds(size_t column) const;
  /// The file that a cell names.
  Result<std::filesystem::path> file(size_t column) const;

  /// "'data/file-000.csv': row 3, column 'timestamp': <what>".
  [[nodiscard]] Status broken(size_t column, std::string_view what) const;

 private:
  RowTable(std::filesystem::path root, std::string title, CsvReader csv)
      : root_(std::move(root)), title_(std::move(title)), csv_(std::move(csv)) {}

  static Result<RowTable> create(std::filesystem::path root, std::string title,
                                 const std::filesystem::path& csv);

  std::filesystem::path root_;  ///< Of images.
  std::string title_;
  CsvReader csv_;
  std::unique_ptr<TemporaryFolder> folder_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, size_t> columns_;  ///< By their names; the first of each.
  std::vector<std::string> cells_;
  uint64_t row_ = 0;
};

/// Where a table is as CSV: beside the Parquet file or, where `looks_in_tables`, in `root`/tables.
/// Empty where it is not.
[[nodiscard]] std::filesystem::path csv_of(const std::filesystem::path& root,
                                           const std::filesystem::path& parquet,
                                           bool looks_in_tables);

}  // namespace engram::datasets::lerobot
