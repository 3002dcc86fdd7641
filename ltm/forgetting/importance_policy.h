// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes what matters least: by the confidence of the producer, or by a number in the value.
///
/// Of several instances the most important one counts. A snapshot without such a number, or with
/// one that is no number (NaN), is never proposed: nobody knows what it is worth.
/// Complexity: reads every snapshot that may go; decodes its media only where `path` is given.
class ImportancePolicy final : public ForgetPolicy {
 public:
  struct Options {
    /// Where the number is, as Data::at reads it. Empty: the confidence.
    std::string path;
    /// Proposed are those below. Nothing: all, the least first.
    std::optional<double> below;

    [[nodiscard]] Status validate() const;
  };

  explicit ImportancePolicy(Options options) : options_(std::move(options)) {}

  [[nodiscard]] std::string reason() const override;
  Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                              const ForgetView& view) override;

 private:
  Result<std::optional<double>> importance(ForgetSource& source, const MemoryId& entity,
                                           const SnapshotEntry& entry) const;

  Options options_;
};

}  // namespace engram::ltm
