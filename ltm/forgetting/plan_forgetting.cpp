// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/plan_forgetting.h"

#include <algorithm>
#include <system_error>

#include "ltm/core/file.h"
#include "ltm/forgetting/forget_planner.h"

namespace engram::ltm {

Result<ForgetContext> ForgetContext::of(const std::filesystem::path& store) {
  ForgetContext context;
  context.now = system_now();
  ENGRAM_ASSIGN_OR_RETURN(context.store_bytes, directory_bytes(store));
  ENGRAM_ASSIGN_OR_RETURN(context.free_disk_bytes, engram::free_disk_bytes(store));
  return context;
}

Result<ForgetPlan> plan_forgetting(ForgetSource& source, const ForgetOptions& options,
                                   const ForgetContext& context) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ForgetPlanner planner(source, options.protection, context);
  ENGRAM_RETURN_IF_ERROR(planner.load(false));
  for (const ForgetRule& rule : options.rules) ENGRAM_RETURN_IF_ERROR(planner.take_by(rule));
  if (options.protection.linked) ENGRAM_RETURN_IF_ERROR(planner.protect_linked());
  ENGRAM_RETURN_IF_ERROR(planner.fade_by(options));
  ENGRAM_RETURN_IF_ERROR(planner.fade_for_quota(options));
  ENGRAM_RETURN_IF_ERROR(planner.take_for_quota(options));
  return planner.finish();
}

ForgetOptions quota_after(const ForgetOptions& options, const ForgetPlan& first) {
  ForgetOptions later = options;
  later.rules.clear();
  later.is_later_round = true;
  later.min_free_disk_bytes.reset();
  const uint64_t min = options.min_free_disk_bytes.value_or(0);
  if (min > first.free_disk_bytes) {
    const uint64_t wanted = min - first.free_disk_bytes;
    const uint64_t max = first.store_bytes - std::min(first.store_bytes, wanted);
    later.max_bytes = std::min(options.max_bytes.value_or(max), max);
  }
  if (!later.max_bytes) {
    later.first.clear();
    later.fade.clear();
  }
  return later;
}

Result<ForgetPlan> plan_forgetting_of(ForgetSource& source, const ForgetSet& chosen,
                                      const ForgetProtection& protection,
                                      const ForgetContext& context) {
  ForgetPlanner planner(source, protection, context);
  ENGRAM_RETURN_IF_ERROR(planner.load(true));
  ENGRAM_RETURN_IF_ERROR(planner.take(chosen, "chosen"));
  if (protection.linked) ENGRAM_RETURN_IF_ERROR(planner.protect_linked());
  return planner.finish();
}

Result<uint64_t> directory_bytes(const std::filesystem::path& directory) {
  std::error_code error;
  uint64_t sum = 0;
  std::filesystem::recursive_directory_iterator entry(
      directory, std::filesystem::directory_options::skip_permission_denied, error);
  for (; !error && entry != std::filesystem::end(entry); entry.increment(error)) {
    // A live writer makes and removes files meanwhile. A file that is gone does not count.
    std::error_code gone;
    if (!entry->is_regular_file(gone) || gone) continue;
    const uintmax_t bytes = entry->file_size(gone);
    if (!gone) sum += bytes;
  }
  if (error && error != std::errc::no_such_file_or_directory)
    return unavailable("directory '{}': {}", directory.string(), error.message());
  return sum;
}

}  // namespace engram::ltm
