// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ltm/forgetting/forget_source.h"

namespace engram::ltm {

/// One entity as a policy sees it.
struct ForgetView {
  MemoryId entity;
  /// Snapshots that no earlier rule takes, in the order of time: a part of them.
  std::span<const SnapshotEntry> snapshots;
  /// For each of them, whether it may be proposed: not protected, sealed, and proposed by the
  /// policies before this one in the same rule.
  const std::vector<bool>& may_go;
};

/// One snapshot that may be forgotten.
struct ForgetProposal {
  size_t snapshot = 0;  ///< Index into ForgetView::snapshots.
  double order = 0;     ///< What is smaller goes first; of equal ones the older.
};

/// Says which snapshots of one entity may go, why, and which of them first. Changes nothing.
///
/// It is made anew for every entity, and sees its snapshots part after part.
/// Threading: one thread.
/// Source: docs/forgetting.md.
class ForgetPolicy {
 public:
  virtual ~ForgetPolicy() = default;

  /// "older than 720h": what plans and reports say.
  [[nodiscard]] virtual std::string reason() const = 0;

  /// Proposes some of those that may go, each once.
  /// Errors: those of ForgetSource.
  virtual Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                                      const ForgetView& view) = 0;
};

}  // namespace engram::ltm
