// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"

namespace engram::server {

/// What is wrong with an audit log.
struct AuditFlaw {
  uint64_t line =
      0;  ///< Counted from 1; the number of lines plus 1 for what is missing at the end.
  std::string what;
};

struct AuditReport {
  static constexpr size_t kMaxFlaws = 100;

  uint64_t lines = 0;
  uint64_t whole = 0;  ///< Records that are as a server wrote them.
  uint64_t flaw_count = 0;
  std::vector<AuditFlaw> flaws;  ///< The first kMaxFlaws of them.
  std::string seal;              ///< Of the last record, as hexadecimal digits.

  [[nodiscard]] bool is_whole() const { return flaw_count == 0; }
};

/// Verifies an audit log with the secret in `key`: every record that was changed, left out, put in
/// or moved is told. The end is verified with the state of the log beside it. A server may be
/// adding to it meanwhile.
/// Errors: kNotFound, kUnavailable; kFailedPrecondition if others can read the key; kCancelled.
/// Threading: thread-safe.
/// Source: docs/access.md, "The audit log".
Result<AuditReport> check_audit_log(const std::filesystem::path& path,
                                    const std::filesystem::path& key, const ProgressSink& progress,
                                    const std::stop_token& stop);

}  // namespace engram::server
