// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Keeps at most `max_rate_hz` snapshots per second, evenly spaced: the first one in each period,
/// counted from the first snapshot. A snapshot may be early by up to a tenth of a period.
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

  /// True if a snapshot at `time` is to be kept. Then it also starts the next period.
  bool is_due(Time time);

 private:
  explicit FrequencyFilter(Duration period) : period_(period) {}

  Duration period_;
  std::optional<Time> next_;
};

}  // namespace engram::ltm
