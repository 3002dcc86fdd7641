// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/forget_options.h"
#include "ltm/forgetting/forget_plan.h"

namespace engram::ltm {

/// The time, sizes and controls that a plan is made with.
struct ForgetContext {
  Time now{};
  uint64_t store_bytes = 0;      ///< Bytes of the store's directory; see directory_bytes.
  uint64_t free_disk_bytes = 0;  ///< Free bytes on its disk.
  ProgressSink progress;
  std::stop_token stop;

  /// Measures `store` now.
  /// Errors: kUnavailable.
  static Result<ForgetContext> of(const std::filesystem::path& store);
};

/// Plans what rules and quotas take. Changes nothing.
/// Errors: kInvalidArgument if the options do not validate; kCancelled; those of ForgetSource.
/// Complexity: that of its policies; about 20 bytes of memory per snapshot, 36 if a quota applies.
Result<ForgetPlan> plan_forgetting(ForgetSource& source, const ForgetOptions& options,
                                   const ForgetContext& context);

/// The quotas of `options` for the rounds after the plan `first`, without the rules. They are
/// stated only as bytes of the directory. Free bytes of the disk are no guide then: files that
/// readers have open, and writes of others, would make each plan take more.
[[nodiscard]] ForgetOptions quota_after(const ForgetOptions& options, const ForgetPlan& first);

/// Finds the snapshots that texts name. Each text is a MemoryId of any level (an instance names its
/// snapshot, a segment all snapshots below it) or a query of docs/query.md with a selector.
/// Errors: kInvalidArgument if a text is neither; kNotFound if one names nothing.
Result<ForgetSet> find_forget_targets(Recall& recall, const std::vector<std::string>& texts);

/// Says of such texts what a reader may have understood otherwise.
[[nodiscard]] std::vector<std::string> notes_on_targets(const std::vector<std::string>& texts);

/// Plans what an explicit choice takes. Only protected entities and, if `protection` asks for it,
/// linked snapshots are kept from it; new snapshots are not. Changes nothing.
/// Errors: those of plan_forgetting.
Result<ForgetPlan> plan_forgetting_of(ForgetSource& source, const ForgetSet& chosen,
                                      const ForgetProtection& protection,
                                      const ForgetContext& context);

/// Bytes of all files below a directory. Files that vanish meanwhile and folders that may not be
/// read do not count.
/// Errors: kUnavailable.
Result<uint64_t> directory_bytes(const std::filesystem::path& directory);

}  // namespace engram::ltm
