// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes snapshots that are not read any more, the longest unread first.
///
/// A snapshot that was never read counts as last read at its own time, so a new snapshot is not
/// proposed at once.
class UnreadPolicy final : public ForgetPolicy {
 public:
  struct Options {
    /// Snapshots whose last read is longer ago than this are proposed. Empty: no such condition.
    std::optional<Duration> unread_for;
    /// Only snapshots that were read less often than this are proposed. Empty: no such condition.
    std::optional<uint64_t> read_less_than;

    [[nodiscard]] Status validate() const;
  };

  UnreadPolicy(const Options& options, Time now) : options_(options), now_(now) {}

  [[nodiscard]] std::string reason() const override;
  Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                              const ForgetView& view) override;

 private:
  Options options_;
  Time now_;
};

}  // namespace engram::ltm
