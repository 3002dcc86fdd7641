// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/query.h"

namespace engram::ltm {

/// A text that names snapshots to forget: a MemoryId of any level (an instance names its snapshot,
/// a segment all snapshots below it), or a query of docs/query.md with a selector.
///
/// A name may have an `@`, so a text may be both: it is the ID if that names anything. A query may
/// take much memory, so read one after the other and keep none.
struct ForgetTarget {
  std::string text;
  std::optional<MemoryId> id;
  std::optional<Query> query;
  /// What the text may mean, in the order in which it is tried: what the ID names, and the query.
  /// They ask for IDs without data.
  std::vector<Query> meanings;

  /// Why the text is no query, if it has an `@`: what to say if the ID names nothing.
  Status not_a_query;

  /// Errors: kInvalidArgument if the text is neither.
  static Result<ForgetTarget> parse(const std::string& text);
};

/// The bound of texts that are given at once: each is looked up for itself.
inline constexpr size_t kMaxForgetTargets = 1024;

/// Checks their number.
/// Errors: kInvalidArgument if there is none or more than kMaxForgetTargets.
[[nodiscard]] Status check_forget_targets(const std::vector<std::string>& texts);

}  // namespace engram::ltm
