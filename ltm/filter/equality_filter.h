// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Drops snapshots whose values are those of the last one kept, bit by bit: type, order of
/// members and NaNs included. Metadata do not count.
///
/// Owns: the last snapshot that it kept, arrays shared with whoever made them.
class EqualityFilter final : public Filter {
 public:
  struct Options {
    /// Keep one at least this often, even without change. Nothing: never for that reason.
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
