// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/memory/query.h"
#include "ltm/memory/select.h"
#include "ltm/store/timeline.h"

namespace engram::datasets {

/// Walks over the snapshots of one entity that a query asks for, in the order of time and without
/// listing them: there may be millions. Decodes nothing.
///
/// Threading: one thread. The timeline must outlive it.
class SnapshotCursor {
 public:
  /// Errors: those of Timeline; here and below.
  static Result<SnapshotCursor> create(ltm::Timeline& timeline,
                                       const std::vector<ltm::SnapshotQuery>& queries);

  /// The next snapshot; nothing behind the last. Moments after the entity's last snapshot that are
  /// asked for come at the end, without an entry's forms.
  struct Step {
    ltm::SnapshotEntry entry;
    bool is_future = false;
    /// Indices of the instances that are asked for; empty: all.
    std::vector<int32_t> instances;
  };
  Result<std::optional<Step>> next();

 private:
  struct Span {
    ltm::Selection::Span times;
    std::vector<int32_t> instances;
  };

  explicit SnapshotCursor(ltm::Timeline& timeline) : timeline_(&timeline) {}

  std::optional<Time> next_start() const;
  std::vector<int32_t> instances_at(Time time) const;

  ltm::Timeline* timeline_;
  std::vector<Span> spans_;
  std::vector<Span> future_;  ///< Each of one moment; in the order of time.
  std::optional<Time> last_;
};

}  // namespace engram::datasets
