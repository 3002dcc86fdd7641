// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Drops snapshots whose values equal those of the last one kept bit by bit, including types, the
/// order of members and NaNs. Metadata do not count.
///
/// Owns: the last snapshot that it kept; its arrays are shared with the caller.
class EqualityFilter final : public Filter {
 public:
  struct Options {
    /// Max time between kept snapshots: then one is kept without a change. Empty: no limit.
    std::optional<Duration> max_gap;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<EqualityFilter> create(const Options& options);

  [[nodiscard]] std::string_view name() const override { return "equality"; }
  void offer(Candidate candidate, FilterDecisions& decisions) override;

 private:
  explicit EqualityFilter(const Options& options) : options_(options) {}

  Options options_;
  std::optional<Snapshot> last_;
};

}  // namespace engram::ltm
