// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Keeps at most `max_rate_hz` snapshots per second, evenly: the first one that falls into each
/// period, counted from the first snapshot, within a tenth of a period.
class FrequencyFilter final : public Filter {
 public:
  struct Options {
    /// Unit: snapshots per second.
    double max_rate_hz = 5;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<FrequencyFilter> create(const Options& options);

  [[nodiscard]] std::string_view name() const override { return "frequency"; }
  void offer(Candidate candidate, FilterDecisions& decisions) override;
  [[nodiscard]] std::optional<std::string_view> drops_at(Time time) const override;

  /// True where a snapshot at `time` is one of those; remembers it then.
  bool is_due(Time time);

 private:
  explicit FrequencyFilter(Duration period) : period_(period) {}

  Duration period_;
  std::optional<Time> next_;
};

}  // namespace engram::ltm
