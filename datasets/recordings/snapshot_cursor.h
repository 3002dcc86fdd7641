// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/memory/query.h"
#include "ltm/memory/select.h"
#include "ltm/store/timeline.h"

namespace engram::datasets {

/// Iterates over the snapshots of one entity that a query selects, in the order of time. It decodes
/// nothing and does not list the snapshots, because there may be millions.
///
/// Threading: one thread. The timeline must outlive it.
class SnapshotCursor {
 public:
  /// `listed` answers conditions; without it they are refused.
  /// Errors: those of Timeline, also of next(); those of `listed`.
  static Result<SnapshotCursor> create(ltm::Timeline& timeline,
                                       const std::vector<ltm::SnapshotQuery>& queries,
                                       const ltm::ListMoments& listed = {});

  /// One snapshot. Selected moments after the entity's last snapshot come at the end; their entry
  /// has no forms.
  struct Step {
    ltm::SnapshotEntry entry;
    bool is_future = false;
    /// Indices of the selected instances; all if empty.
    std::vector<int32_t> instances;
  };
  Result<std::optional<Step>> next();

 private:
  struct Span {
    ltm::Selection::Span times;
    std::vector<int32_t> instances;
    /// The moments that it has, if it does not have all between its ends.
    std::optional<ltm::ListedMoments> listed{};
  };

  explicit SnapshotCursor(ltm::Timeline& timeline) : timeline_(&timeline) {}

  [[nodiscard]] static bool has(const Span& span, Time time);
  std::optional<Time> next_start() const;
  std::vector<int32_t> instances_at(Time time) const;

  ltm::Timeline* timeline_;
  std::vector<Span> spans_;
  std::vector<Span> future_;  ///< One moment each, in the order of time.
  std::optional<Time> last_;
};

}  // namespace engram::datasets
