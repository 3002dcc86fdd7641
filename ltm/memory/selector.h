// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "ltm/core/time.h"

namespace engram::ltm {

using engram::to_string;

/// The kinds of selectors: each selects some of an entity's snapshots.
namespace select {
struct All {
  friend bool operator==(All, All) = default;
};
/// The last `count` snapshots, oldest first.
struct Latest {
  int64_t count = 1;
  friend bool operator==(Latest, Latest) = default;
};
/// The snapshot of exactly this time; a prediction where it lies after the last one.
struct At {
  Time time{};
  friend bool operator==(At, At) = default;
};
/// A prediction `offset` after the last snapshot.
struct Ahead {
  Duration offset{};
  friend bool operator==(Ahead, Ahead) = default;
};
/// The snapshot closest in time, if it is within the tolerance.
struct Nearest {
  Time time{};
  Duration tolerance = Duration::max();
  friend bool operator==(Nearest, Nearest) = default;
};
/// The last snapshot before `time`, or at it where `is_inclusive`.
struct Before {
  Time time{};
  bool is_inclusive = false;
  friend bool operator==(Before, Before) = default;
};
/// The first snapshot after `time`.
struct After {
  Time time{};
  friend bool operator==(After, After) = default;
};
/// The snapshots of a range of time, both ends included.
struct TimeRange {
  Time first{};
  Time last{};
  friend bool operator==(TimeRange, TimeRange) = default;
};
/// The snapshots that are at most `duration` older than the last one.
struct LastDuration {
  Duration duration{};
  friend bool operator==(LastDuration, LastDuration) = default;
};
/// The snapshots of a range of indices, both ends included. Negative indices count from the end; -1
/// is the last.
struct IndexRange {
  int64_t first = 0;
  int64_t last = -1;
  friend bool operator==(IndexRange, IndexRange) = default;
};
}  // namespace select

using Selector = std::variant<select::All, select::Latest, select::At, select::Ahead,
                              select::Nearest, select::Before, select::After, select::TimeRange,
                              select::LastDuration, select::IndexRange>;

/// Checks the values of a selector.
/// Errors: kInvalidArgument where a count is not positive, a duration or tolerance is negative, or
/// a time range ends before it starts.
[[nodiscard]] Status validate(const Selector& selector);

/// Reads `all`, `latest`, `latest:3`, `T`, `+200ms`, `nearest:T`, `nearest:T~50ms`, `before:T`,
/// `at-or-before:T`, `after:T`, `until:T`, `T1..T2`, `last:10s`, `-3..-1`. Two bare integers below 10^9 are
/// indices; the prefixes `time:` and `index:` decide explicitly.
/// Errors: kInvalidArgument naming the text and what was needed.
Result<Selector> parse_selector(std::string_view text);

/// A text that parse_selector reads back to the same selector, if it validates.
[[nodiscard]] std::string to_string(const Selector& selector);

}  // namespace engram::ltm
