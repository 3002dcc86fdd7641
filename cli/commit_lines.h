// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <string_view>

#include "ltm/memory/commit.h"

namespace engram::cli {

/// Parses a snapshot from a line of JSON, as `engram watch --data --json` and `engram export --to
/// jsonl` write it, or
///
///     {"entity": "Vision/RGB/head/cam", "time": T, "data": VALUE}
///
/// with "instances": [{"data": VALUE, ...}, ...] in place of "data", or with the snapshot's "id" in
/// place of entity and time. Without a time it is `now`. VALUE is IDF's JSON form.
/// Errors: kInvalidArgument naming what was found and what was needed; predictions are refused.
Result<ltm::EntityUpdate> parse_commit_line(std::string_view line, Time now);

/// Reads lines and passes them to `take` in batches. A batch ends when the next line is not
/// available yet, so no snapshot waits for a later one. Empty lines are skipped. Returns the number
/// of snapshots taken.
/// Errors: those of parse_commit_line and `take`, naming the lines; earlier batches stay committed.
Result<size_t> commit_lines(std::istream& lines,
                            const std::function<Status(const ltm::Commit&)>& take);

}  // namespace engram::cli
