// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the rows of the episodes, one after the other.

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/lerobot/lerobot_table.h"

namespace engram::datasets::lerobot {

/// Iterates over the rows of episodes, whether each has its own table or many share one.
///
/// Errors: those of RowTable; kDataLoss if an episode has more or fewer rows than the list of
/// episodes says. Memory: one row. Threading: one thread.
class StepRows {
 public:
  /// `description` must outlive this.
  explicit StepRows(const Description& description) : description_(description) {}

  /// Goes to the first row of `episode`. Returns true if the table, and therefore the columns,
  /// changed.
  Result<bool> begin(const Episode& episode);

  /// Goes to the next row of the current episode.
  Status next();

  /// Fails if the table of the current episode has further rows, unless many episodes share it.
  Status end();

  [[nodiscard]] const RowTable& table() const { return *table_; }

  /// The time of the row since the start of the episode.
  Result<Duration> time() const { return table_->seconds(time_column_); }
  [[nodiscard]] Status wrong_time(std::string_view what) const {
    return table_->broken(time_column_, what);
  }

 private:
  Status fetch();
  Result<bool> find(const Episode& episode);
  [[nodiscard]] std::string name() const { return (description_.root / path_).string(); }

  const Description& description_;
  std::optional<RowTable> table_;
  std::filesystem::path path_;
  size_t time_column_ = 0;
  size_t episode_column_ = 0;
  bool is_waiting_ = false;  ///< A row was fetched from the table and not taken yet.

  std::string episode_;  ///< The current episode.
  int64_t index_ = 0;
  int64_t length_ = 0;
  int64_t taken_ = 0;
};

}  // namespace engram::datasets::lerobot
