// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes the least important snapshots, by the confidence of the producer or by a number in the
/// value.
///
/// Of several instances the most important one counts. A snapshot without the number, or with NaN,
/// is never proposed, because its importance is unknown.
/// Complexity: reads every snapshot that may go; decodes its media only if `path` is given.
class ImportancePolicy final : public ForgetPolicy {
 public:
  struct Options {
    /// Path of the number, as Data::at reads it. Empty: the confidence is used.
    std::string path;
    /// Snapshots with less than this are proposed. Empty: all are, the least important first.
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
