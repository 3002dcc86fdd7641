// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ltm/core/time.h"
#include "server/robot/host_state.h"

namespace engram::server {

/// Says what working memory may take while the machine has other things to do, too.
///
/// RAM is tight where less than `shrink_below` of it is available, or where programs wait for it
/// (PSI). Then the limit becomes a share of what the memory takes, again and again, down to a
/// floor. It grows by small steps once more than `grow_above` has been available, and nobody has
/// waited, for a while; what the limit allows and is not taken yet counts as taken. Between the
/// two nothing changes, so it does not swing.
///
/// Several servers on one machine each follow this rule for their own memory, and need to know
/// nothing of each other: all shrink by the same share, and each step up leaves three quarters of
/// what is free above the threshold.
/// Threading: one thread.
class LimitGovernor {
 public:
  struct Options {
    uint64_t configured_bytes = uint64_t{512} << 20;  ///< Where RAM is not tight.
    uint64_t floor_bytes = uint64_t{32} << 20;        ///< Never less.
    double shrink_below = 0.10;                       ///< Share of the RAM that is available.
    double grow_above = 0.20;                         ///< The same; more than shrink_below.
    double shrink_pressure = 10;                      ///< Memory pressure, `some` of 10 s. Unit: %.
    double grow_pressure = 2;                         ///< The same; less than shrink_pressure.
    double shrink_factor = 0.7;                       ///< Of what the memory takes.
    double grow_share = 0.05;                         ///< Largest step, of `configured_bytes`.
    Duration shrink_interval = std::chrono::seconds(3);  ///< Until it was seen what it helped.
    /// The same where pressure alone is high: its measure looks back 10 s.
    Duration pressure_interval = std::chrono::seconds(10);
    Duration grow_interval = std::chrono::seconds(5);
    Duration calm = std::chrono::seconds(30);  ///< Before it grows.

    [[nodiscard]] Status validate() const;
  };

  /// The limit changed, and why: a sentence for people, which names the numbers.
  struct Change {
    uint64_t before_bytes = 0;
    uint64_t after_bytes = 0;
    std::string reason;
  };

  /// Errors: kInvalidArgument.
  static Result<LimitGovernor> create(const Options& options);

  /// Looks at a new reading; `taken_bytes` is what the memory takes right now. Nothing where the
  /// limit stays. Time: `now` does not decrease.
  std::optional<Change> update(SteadyTime now, const HostState& host, uint64_t taken_bytes);

  /// What holds now, and why.
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
