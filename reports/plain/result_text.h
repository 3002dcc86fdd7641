// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/memory/result.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Describes what a snapshot holds: "image uint8 [128, 128, 3]", "52 numbers", or a short value
/// itself.
[[nodiscard]] std::string content_text(const ltm::Snapshot& snapshot);

/// Prints the answer to a query as tables or as JSON. A non-empty `save` names a folder below which
/// its data are written.
/// Errors: those of snapshot_json and save_snapshot.
Status show_result(const ltm::QueryResult& result, const std::string& save, bool is_json);

}  // namespace engram::reports
