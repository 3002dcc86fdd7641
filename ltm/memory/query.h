// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// Which of an entity's snapshots a query means.
namespace select {
struct All {
  friend bool operator==(All, All) = default;
};
/// The last `count`, oldest first.
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
/// The closest in time, if within the tolerance.
struct Nearest {
  Time time{};
  Duration tolerance = Duration::max();
  friend bool operator==(Nearest, Nearest) = default;
};
/// The last one before `time`, or at it where `is_inclusive`.
struct Before {
  Time time{};
  bool is_inclusive = false;
  friend bool operator==(Before, Before) = default;
};
/// The first one after `time`.
struct After {
  Time time{};
  friend bool operator==(After, After) = default;
};
/// Both ends included.
struct TimeRange {
  Time first{};
  Time last{};
  friend bool operator==(TimeRange, TimeRange) = default;
};
/// Not older than `duration` before the last one.
struct LastDuration {
  Duration duration{};
  friend bool operator==(LastDuration, LastDuration) = default;
};
/// Both ends included; negative counts from the end, -1 is the last.
struct IndexRange {
  int64_t first = 0;
  int64_t last = -1;
  friend bool operator==(IndexRange, IndexRange) = default;
};
}  // namespace select

using Selector = std::variant<select::All, select::Latest, select::At, select::Ahead,
                              select::Nearest, select::Before, select::After, select::TimeRange,
                              select::LastDuration, select::IndexRange>;

/// Matches the names of one level of the hierarchy: one name, or an RE2 regular expression that
/// must match the whole name.
///
/// Threading: immutable.
class NamePattern {
 public:
  /// Every name.
  NamePattern() : text_(".*") {}

  /// A text without `. * + ? ( ) [ ] { } | ^ $ \` is one name, any other an expression.
  /// Errors: kInvalidArgument where the expression is broken.
  static Result<NamePattern> parse(std::string_view text);

  [[nodiscard]] bool matches(std::string_view name) const;
  [[nodiscard]] const std::string& text() const { return text_; }

  friend bool operator==(const NamePattern&, const NamePattern&) = default;

 private:
  std::string text_;
};

/// A question to a memory: which entities, and which of their snapshots.
///
/// Text form: `<memory>/<core>/<provider>/<entity> @ <selector>`; missing levels match all, a
/// missing selector is `latest`. Selectors: `all`, `latest`, `latest:3`, `T`, `+200ms`,
/// `nearest:T`, `nearest:T~50ms`, `before:T`, `at-or-before:T`, `after:T`, `T1..T2`, `last:10s`,
/// `-3..-1`. Two bare integers below 10^9 are indices; `time:` and `index:` say it outright.
/// Source: docs/design.md, section 2.
class Query {
 public:
  /// Everything's latest.
  Query() = default;
  Query(std::array<NamePattern, MemoryId::kNameLevels> names, Selector selector)
      : names_(std::move(names)), selector_(selector) {}

  /// Errors: kInvalidArgument naming the text, the part that does not fit and what was needed.
  static Result<Query> parse(std::string_view text);

  /// The query of exactly one entity.
  static Query of_entity(const MemoryId& entity, Selector selector);

  [[nodiscard]] bool matches(const MemoryId& entity) const;
  [[nodiscard]] const Selector& selector() const { return selector_; }
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const Query&, const Query&) = default;

 private:
  std::array<NamePattern, MemoryId::kNameLevels> names_;
  Selector selector_ = select::Latest{};
};

}  // namespace engram::ltm
