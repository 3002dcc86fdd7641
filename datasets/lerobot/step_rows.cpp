// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/step_rows.h"

namespace engram::datasets::lerobot {

Status StepRows::fetch() {
  if (is_waiting_) return {};
  ENGRAM_ASSIGN_OR_RETURN(is_waiting_, table_->next());
  return {};
}

/// Skips rows of other episodes up to the first one of this; returns false if there is none.
Result<bool> StepRows::find(const Episode& episode) {
  while (true) {
    ENGRAM_RETURN_IF_ERROR(fetch());
    if (!is_waiting_) return false;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t index, table_->whole(episode_column_));
    if (index == episode.index) return true;
    is_waiting_ = false;
  }
}

Result<bool> StepRows::begin(const Episode& episode) {
  episode_ = episode.name();
  index_ = episode.index;
  length_ = episode.length;
  taken_ = 0;
  const std::filesystem::path path = description_.table_of(episode);
  if (description_.is_v3 && table_ && path == path_) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_there, find(episode));
    if (is_there) return false;
  }
  path_ = path;
  is_waiting_ = false;
  ENGRAM_ASSIGN_OR_RETURN(table_, RowTable::open(description_.root, path, !description_.is_v3));
  ENGRAM_ASSIGN_OR_RETURN(time_column_, table_->need("timestamp"));
  if (!description_.is_v3) return true;
  ENGRAM_ASSIGN_OR_RETURN(episode_column_, table_->need("episode_index"));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, find(episode));
  if (is_there) return true;
  return data_loss("'{}': found no row of {}, needs {}", name(), episode_, length_);
}

Status StepRows::next() {
  ENGRAM_RETURN_IF_ERROR(fetch());
  bool is_there = is_waiting_;
  if (is_there && description_.is_v3) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t index, table_->whole(episode_column_));
    is_there = index == index_;
  }
  if (!is_there)
    return data_loss("'{}': found {} rows of {}, needs {} as the list of episodes says", name(),
                     taken_, episode_, length_);
  is_waiting_ = false;
  ++taken_;
  return {};
}

Status StepRows::end() {
  if (description_.is_v3) return {};
  ENGRAM_RETURN_IF_ERROR(fetch());
  if (!is_waiting_) return {};
  return data_loss("'{}': found more than {} rows, needs as many as the list of episodes says",
                   name(), length_);
}

}  // namespace engram::datasets::lerobot
