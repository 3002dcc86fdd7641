// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ltm/forgetting/forget_source.h"

namespace engram::ltm {

/// The view of one entity that a policy gets.
struct ForgetView {
  MemoryId entity;
  /// A part of the snapshots that no earlier rule took, sorted by time.
  std::span<const SnapshotEntry> snapshots;
  /// For each of them, whether it may be proposed: it is sealed, not protected, and proposed by
  /// the policies before this one in the same rule.
  const std::vector<bool>& may_go;
};

/// One snapshot that may be forgotten.
struct ForgetProposal {
  size_t snapshot = 0;  ///< Index into ForgetView::snapshots.
  double order = 0;     ///< The smaller one goes first; of equal ones the older.
};

/// Decides which snapshots of one entity may go, why, and which of them first. Changes nothing.
///
/// A new policy is made for every entity, and gets its snapshots in consecutive parts.
/// Threading: one thread.
/// Source: docs/forgetting.md.
class ForgetPolicy {
 public:
  virtual ~ForgetPolicy() = default;

  /// The reason in plans and reports, such as "older than 720h".
  [[nodiscard]] virtual std::string reason() const = 0;

  /// Proposes some of the snapshots that may go, each at most once.
  /// Errors: those of ForgetSource.
  virtual Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                                      const ForgetView& view) = 0;
};

}  // namespace engram::ltm
