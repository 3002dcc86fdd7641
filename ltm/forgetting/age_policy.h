// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes old snapshots, the oldest first.
class AgePolicy final : public ForgetPolicy {
 public:
  struct Options {
    /// Snapshots older than this are proposed. Empty: all are proposed.
    std::optional<Duration> older_than;

    [[nodiscard]] Status validate() const;
  };

  AgePolicy(const Options& options, Time now) : options_(options), now_(now) {}

  [[nodiscard]] std::string reason() const override;
  Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                              const ForgetView& view) override;

 private:
  Options options_;
  Time now_;
};

}  // namespace engram::ltm
