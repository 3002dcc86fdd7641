// SPDX-License-Identifier: Apache-2.0
#include "server/robot/limit_governor.h"

#include <algorithm>

namespace engram::server {

namespace {

/// The min step up: a smaller one is not worth a change and its line in the log.
constexpr uint64_t kSmallestStep = uint64_t{1} << 20;

double share_available(const RamState& ram) {
  return static_cast<double>(ram.available_bytes) / static_cast<double>(ram.total_bytes);
}

uint64_t share_of(uint64_t bytes, double share) {
  return static_cast<uint64_t>(static_cast<double>(bytes) * share);
}

std::string available_text(const RamState& ram) {
  return fmt::format("{} of {} MiB of RAM ({:.0f} %) are available",
                     ram.available_bytes / kMebibyte, ram.total_bytes / kMebibyte,
                     100 * share_available(ram));
}

}  // namespace

Status LimitGovernor::Options::validate() const {
  if (floor_bytes == 0 || configured_bytes < floor_bytes)
    return invalid_argument(
        "RAM limit: found {} bytes and a floor of {}, needs more than 0, the "
        "floor not above",
        configured_bytes, floor_bytes);
  if (!(0 < shrink_below && shrink_below < grow_above && grow_above < 1))
    return invalid_argument(
        "RAM limit: found shrink_below {} and grow_above {}, needs 0 < the "
        "first < the second < 1",
        shrink_below, grow_above);
  if (!(0 <= grow_pressure && grow_pressure < shrink_pressure && shrink_pressure <= 100))
    return invalid_argument(
        "RAM limit: found grow_pressure {} and shrink_pressure {}, needs 0 <= "
        "the first < the second <= 100",
        grow_pressure, shrink_pressure);
  if (!(0 < shrink_factor && shrink_factor < 1) || !(0 < grow_share && grow_share <= 1))
    return invalid_argument(
        "RAM limit: found shrink_factor {} and grow_share {}, needs both "
        "between 0 and 1",
        shrink_factor, grow_share);
  if (std::min({shrink_interval, pressure_interval, grow_interval, calm}) < Duration(0))
    return invalid_argument("RAM limit: found a negative duration");
  return {};
}

LimitGovernor::LimitGovernor(const Options& options)
    : options_(options), limit_{options.configured_bytes, "as configured"} {}

Result<LimitGovernor> LimitGovernor::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return LimitGovernor(options);
}

std::optional<LimitGovernor::Change> LimitGovernor::update(SteadyTime now, const HostState& host,
                                                           uint64_t taken_bytes) {
  const RamState& ram = host.tightest_ram();
  if (ram.total_bytes == 0) return std::nullopt;
  // Available RAM is tested before pressure because it reacts at once, while pressure is an average
  // of 10 s and needs the longer interval.
  const double pressure = host.memory_pressure ? host.memory_pressure->some : 0;
  const auto may_shrink = [&](Duration interval) {
    return !changed_ || now - *changed_ >= interval;
  };
  if (share_available(ram) < options_.shrink_below) {
    calm_since_.reset();
    if (!may_shrink(options_.shrink_interval)) return std::nullopt;
    return shrink(
        now, taken_bytes,
        fmt::format("{}, below {:.0f} %", available_text(ram), 100 * options_.shrink_below));
  }
  if (pressure > options_.shrink_pressure) {
    calm_since_.reset();
    if (!may_shrink(options_.pressure_interval)) return std::nullopt;
    return shrink(now, taken_bytes,
                  fmt::format("programs waited for RAM {:.0f} % of the last 10 s, above {:.0f} %",
                              pressure, options_.shrink_pressure));
  }
  if (share_available(ram) < options_.grow_above || pressure > options_.grow_pressure) {
    calm_since_.reset();
    return std::nullopt;
  }
  if (!calm_since_) calm_since_ = now;
  return grow(now, ram, taken_bytes);
}

std::optional<LimitGovernor::Change> LimitGovernor::shrink(SteadyTime now, uint64_t taken_bytes,
                                                           const std::string& why) {
  // The share is of what the memory takes, not of the limit: shrinking a limit that is not used up
  // would free nothing.
  const uint64_t share = share_of(std::min(limit_.bytes, taken_bytes), options_.shrink_factor);
  const uint64_t after = std::max(options_.floor_bytes, share);
  if (after >= limit_.bytes) return std::nullopt;
  return change_to(now, after, fmt::format("shrinks: {}", why));
}

std::optional<LimitGovernor::Change> LimitGovernor::grow(SteadyTime now, const RamState& ram,
                                                         uint64_t taken_bytes) {
  if (limit_.bytes >= options_.configured_bytes || now - *calm_since_ < options_.calm ||
      (changed_ && now - *changed_ < options_.grow_interval))
    return std::nullopt;
  // RAM that the limit allows but the memory does not use yet may be claimed at any time, so it is
  // not free for a larger limit. A quarter of the rest per step leaves room for other servers that
  // grow at the same time.
  const uint64_t not_taken = limit_.bytes - std::min(limit_.bytes, taken_bytes);
  const uint64_t kept = share_of(ram.total_bytes, options_.grow_above) + not_taken;
  const uint64_t room = ram.available_bytes - std::min(ram.available_bytes, kept);
  const uint64_t missing = options_.configured_bytes - limit_.bytes;
  const uint64_t largest = share_of(options_.configured_bytes, options_.grow_share);
  const uint64_t step = std::min({room / 4, std::max(largest, kSmallestStep), missing});
  if (step < std::min(missing, kSmallestStep)) return std::nullopt;
  const bool is_all = step == missing;
  return change_to(now, limit_.bytes + step,
                   is_all ? fmt::format("as configured again: {}", available_text(ram))
                          : fmt::format("grows: {}", available_text(ram)));
}

LimitGovernor::Change LimitGovernor::change_to(SteadyTime now, uint64_t bytes, std::string reason) {
  const Change change{limit_.bytes, bytes, std::move(reason)};
  limit_ = {bytes, change.reason};
  changed_ = now;
  return change;
}

}  // namespace engram::server
