// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes what nobody asks for, the longest unread first.
///
/// A snapshot that was never read counts as last read at its own time: what is new is not unread
/// for long.
class UnreadPolicy final : public ForgetPolicy {
 public:
  struct Options {
    /// Proposed are those whose last read is more than this before now. Nothing: all.
    std::optional<Duration> unread_for;
    /// And that were read less often than this. Nothing: however often.
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
