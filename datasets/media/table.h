// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"

namespace engram::datasets {

/// The unit of times that are given as bare numbers.
enum class TimeUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };

/// Reads "s", "ms", "us" or "ns".
/// Errors: kInvalidArgument.
Result<TimeUnit> parse_time_unit(std::string_view text);

/// Reads a decimal number ("12.5", "-3e-4") as a time without converting it to a double. The result
/// is exact; digits finer than a nanosecond are rounded half away from zero.
/// Errors: kInvalidArgument naming the text if it is not a number or exceeds 292 years.
Result<Duration> parse_decimal_time(std::string_view text, TimeUnit unit);

/// One named column of numbers. The numbers are always doubles: whether a file happens to hold only
/// whole numbers must not change the type of an entity.
struct TableColumn {
  std::string name;
  std::vector<double> values;
};

/// A table of numbers over time, read from a comma-separated file with a header line.
///
/// The time column is not one of the columns. Times strictly increase from row to row.
/// Memory: eight bytes per number.
/// Threading: immutable.
class Table {
 public:
  struct Options {
    /// If empty, the first column named timestamp, time, t or stamp, in upper or lower case.
    std::string time_column;
    TimeUnit time_unit = TimeUnit::kSeconds;
    /// Columns to leave out, such as row numbers and texts.
    std::vector<std::string> skip_columns;
  };

  /// Errors: kNotFound if there is no such file; kInvalidArgument naming file, line and column,
  /// what was found and what was needed; kUnavailable if the disk fails.
  static Result<Table> read(const std::filesystem::path& path, const Options& options);

  [[nodiscard]] size_t rows() const { return times_.size(); }
  [[nodiscard]] const std::vector<TableColumn>& columns() const { return columns_; }

  /// The times of the rows as in the file, whatever they count from. There is at least one row.
  [[nodiscard]] const std::vector<Duration>& times() const { return times_; }

  /// Returns the row as nested dicts: the column "state.elbow" is {"state": {"elbow": number}}, in
  /// the order of the columns. `row` must be less than rows() (checked).
  [[nodiscard]] idf::Data row_value(size_t row) const;

 private:
  /// A column, or the dict of all columns whose names have a common prefix.
  struct Node {
    std::string key;
    size_t column = 0;  ///< The column, if there are no children.
    std::vector<Node> children;
  };

  class Builder;

  [[nodiscard]] idf::Data value_of(const Node& node, size_t row) const;

  std::vector<TableColumn> columns_;
  std::vector<Duration> times_;
  Node root_;
};

}  // namespace engram::datasets
