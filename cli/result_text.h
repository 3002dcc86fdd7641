// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"
#include "ltm/memory/result.h"

namespace engram::cli {

/// "image uint8 [128, 128, 3]", "52 numbers", a short value itself: what a snapshot holds.
[[nodiscard]] std::string content_text(const ltm::Snapshot& snapshot);

/// Prints the answer to a query, as tables or as JSON; with `save`, writes what it holds below that
/// folder. Tells what fails.
ExitCode show_result(const ltm::QueryResult& result, const std::string& save, bool is_json);

}  // namespace engram::cli
