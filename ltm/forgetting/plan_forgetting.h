// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/forget_options.h"
#include "ltm/forgetting/forget_plan.h"

namespace engram::ltm {

/// The world in which a plan is made.
struct ForgetContext {
  Time now{};
  uint64_t store_bytes = 0;      ///< Of the store's directory; see directory_bytes.
  uint64_t free_disk_bytes = 0;  ///< On its disk.
  ProgressSink progress;
  std::stop_token stop;

  /// Measures `store` now.
  /// Errors: kUnavailable.
  static Result<ForgetContext> of(const std::filesystem::path& store);
};

/// What rules and quotas take. Changes nothing.
/// Errors: kInvalidArgument where the options do not validate; kCancelled; those of ForgetSource.
/// Complexity: as its policies; about 20 bytes of memory per snapshot, 36 where a quota applies.
Result<ForgetPlan> plan_forgetting(ForgetSource& source, const ForgetOptions& options,
                                   const ForgetContext& context);

/// The quotas of `options` for rounds that follow `first`, without the rules: as bytes of the
/// directory alone. What the disk has free says little then: files that a reader has open, and what
/// others write, would make a plan take ever more.
[[nodiscard]] ForgetOptions quota_after(const ForgetOptions& options, const ForgetPlan& first);

/// The snapshots that texts name, each a MemoryId of any level (of an instance: its snapshot; of a
/// segment: all below it) or a query of docs/query.md, which is one where it has a selector.
/// Errors: kInvalidArgument where a text is neither; kNotFound where one names nothing.
Result<ForgetSet> find_forget_targets(Recall& recall, const std::vector<std::string>& texts);

/// What an explicit choice takes: only protected entities and, where asked for, linked snapshots
/// are kept from it, not what is new. Changes nothing.
/// Errors: those of plan_forgetting.
Result<ForgetPlan> plan_forgetting_of(ForgetSource& source, const ForgetSet& chosen,
                                      const ForgetProtection& protection,
                                      const ForgetContext& context);

/// Bytes of all files below a directory, as far as they can be seen.
/// Errors: kUnavailable.
Result<uint64_t> directory_bytes(const std::filesystem::path& directory);

}  // namespace engram::ltm
