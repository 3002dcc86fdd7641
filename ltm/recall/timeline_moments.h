// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/memory/select.h"
#include "ltm/store/timeline.h"

namespace engram::ltm {

/// Adapts the timeline of an entity in a store to the interface that selectors read.
///
/// Threading: as Timeline.
class TimelineMoments final : public Moments {
 public:
  /// `timeline` must outlive it.
  explicit TimelineMoments(Timeline& timeline) : timeline_(timeline) {}

  Result<std::optional<Time>> first() override { return timeline_.first(); }
  Result<std::optional<Time>> last() override { return timeline_.last(); }
  Result<std::optional<Time>> at_or_after(Time time) override {
    return time_of(timeline_.at_or_after(time));
  }
  Result<std::optional<Time>> at_or_before(Time time) override {
    return time_of(timeline_.at_or_before(time));
  }
  Result<std::optional<Time>> nth(uint64_t index) override { return time_of(timeline_.nth(index)); }

 private:
  static Result<std::optional<Time>> time_of(const Result<std::optional<SnapshotEntry>>& entry) {
    if (!entry.ok()) return entry.status();
    return entry.value() ? std::optional((*entry)->time) : std::nullopt;
  }

  Timeline& timeline_;
};

}  // namespace engram::ltm
