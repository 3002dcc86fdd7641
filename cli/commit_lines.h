// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <string_view>

#include "ltm/memory/commit.h"

namespace engram::cli {

/// Reads a snapshot as a line of JSON: what `engram watch --data --json` and
/// `engram export --to jsonl` write, or
///
///     {"entity": "Vision/RGB/head/cam", "time": T, "data": VALUE}
///
/// with "instances": [{"data": VALUE, ...}, ...] in place of "data", or "id" of the snapshot in
/// place of entity and time. Without a time it is `now`. VALUE is IDF's JSON form.
/// Errors: kInvalidArgument naming what was found and needed; predictions are refused.
Result<ltm::EntityUpdate> parse_commit_line(std::string_view line, Time now);

/// Reads lines and hands them over, many at once, but none later than it has to wait for the next
/// one. Empty lines are passed over. Returns how many snapshots were taken.
/// Errors: those of parse_commit_line and `take`, naming the lines; what was taken before stays.
Result<size_t> commit_lines(std::istream& lines,
                            const std::function<Status(const ltm::Commit&)>& take);

}  // namespace engram::cli
