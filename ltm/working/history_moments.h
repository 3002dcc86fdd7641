// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the snapshots of an entity in memory, as the selectors of queries see them.

#include <optional>

#include "ltm/memory/select.h"
#include "ltm/working/entity_history.h"

namespace engram::ltm {

/// The times of an entity's snapshots in working memory. It notes whether a search reached
/// snapshots up to `elsewhere`, which are not all here and could change the answer.
class HistoryMoments final : public Moments {
 public:
  HistoryMoments(const EntityHistory& history, std::optional<Time> elsewhere)
      : history_(history), elsewhere_(elsewhere) {}

  [[nodiscard]] bool reaches_elsewhere() const { return reaches_elsewhere_; }

  Result<std::optional<Time>> first() override {
    if (elsewhere_) reaches_elsewhere_ = true;
    return time_of(0);
  }
  Result<std::optional<Time>> last() override {
    return unless_earlier(time_of(history_.size() - 1));
  }
  Result<std::optional<Time>> at_or_after(Time time) override {
    if (elsewhere_ && time <= *elsewhere_) reaches_elsewhere_ = true;
    return time_of(history_.lower_bound(time));
  }
  Result<std::optional<Time>> at_or_before(Time time) override {
    const size_t index = history_.lower_bound(time);
    const bool is_it = index < history_.size() && history_[index].time == time;
    return unless_earlier(time_of(is_it ? index : index - 1));
  }
  Result<std::optional<Time>> nth(uint64_t index) override {
    if (elsewhere_) reaches_elsewhere_ = true;
    return index < history_.size() ? time_of(static_cast<size_t>(index)) : std::nullopt;
  }

 private:
  /// Nothing before the first and beyond the last.
  [[nodiscard]] std::optional<Time> time_of(size_t index) const {
    return index < history_.size() ? std::optional(history_[index].time) : std::nullopt;
  }

  /// Where the time is earlier than `elsewhere`, a later one could lie elsewhere.
  [[nodiscard]] std::optional<Time> unless_earlier(std::optional<Time> time) const {
    if (elsewhere_ && (!time || *time < *elsewhere_)) reaches_elsewhere_ = true;
    return time;
  }

  const EntityHistory& history_;
  const std::optional<Time> elsewhere_;
  mutable bool reaches_elsewhere_ = false;
};

}  // namespace engram::ltm
