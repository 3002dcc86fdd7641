// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ltm/core/time.h"
#include "server/robot/host_state.h"

namespace engram::server {

inline constexpr uint64_t kMebibyte = uint64_t{1} << 20;

/// Decides how much RAM working memory may take while other programs of the machine need RAM too.
///
/// RAM is tight if less than `shrink_below` of it is available, or if programs wait for it (PSI).
/// The limit then becomes a share of what the memory takes, repeatedly, down to a floor. It grows
/// in small steps once more than `grow_above` has been available and no program has waited for a
/// while; RAM that the limit allows but the memory does not use yet counts as used. Between the two
/// thresholds the limit stays, so that it does not oscillate.
///
/// Several servers on one machine follow this rule independently: all shrink by the same share, and
/// each step up leaves three quarters of what is free above the threshold.
/// Threading: one thread.
class LimitGovernor {
 public:
  struct Options {
    uint64_t configured_bytes = uint64_t{512} << 20;  ///< The limit while RAM is not tight.
    uint64_t floor_bytes = uint64_t{32} << 20;        ///< The min of the limit.
    /// Shrinks below this available share of the RAM.
    double shrink_below = 0.10;
    /// Grows above this share; must exceed shrink_below.
    double grow_above = 0.20;
    /// Shrinks above this memory pressure, `some` of 10 s. Unit: %.
    double shrink_pressure = 10;
    /// Grows below this pressure; must be less than shrink_pressure. Unit: %.
    double grow_pressure = 2;
    /// The new limit, as a share of what the memory takes.
    double shrink_factor = 0.7;
    /// The max step up, as a share of `configured_bytes`.
    double grow_share = 0.05;
    /// The wait after a change before the limit shrinks again, so that its effect is visible.
    Duration shrink_interval = std::chrono::seconds(3);
    /// The same wait if pressure alone is high: longer, because pressure averages the last 10 s.
    Duration pressure_interval = std::chrono::seconds(10);
    /// The wait after a change before the limit grows.
    Duration grow_interval = std::chrono::seconds(5);
    /// How long RAM must not have been tight before the limit grows.
    Duration calm = std::chrono::seconds(30);

    [[nodiscard]] Status validate() const;
  };

  /// A change of the limit. `reason` is a sentence for people that names the numbers.
  struct Change {
    uint64_t before_bytes = 0;
    uint64_t after_bytes = 0;
    std::string reason;
  };

  /// Errors: kInvalidArgument.
  static Result<LimitGovernor> create(const Options& options);

  /// Evaluates a new reading. `taken_bytes` is what the memory takes right now. Returns nothing if
  /// the limit stays.
  /// Time: `now` must not decrease.
  std::optional<Change> update(SteadyTime now, const HostState& host, uint64_t taken_bytes);

  /// The current limit and its reason.
  [[nodiscard]] const RamLimit& limit() const { return limit_; }

 private:
  explicit LimitGovernor(const Options& options);

  std::optional<Change> shrink(SteadyTime now, uint64_t taken_bytes, const std::string& why);
  std::optional<Change> grow(SteadyTime now, const RamState& ram, uint64_t taken_bytes);
  Change change_to(SteadyTime now, uint64_t bytes, std::string reason);

  Options options_;
  RamLimit limit_;
  std::optional<SteadyTime> changed_;
  std::optional<SteadyTime> calm_since_;
};

}  // namespace engram::server
