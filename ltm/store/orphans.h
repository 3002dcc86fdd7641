// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/store/finding.h"

namespace engram::ltm {

/// Files of a store that no reader looks at: what killed processes left, sealed journals, journals
/// that are kept since they were damaged. A note each.
/// Errors: those of read_manifest; kUnavailable.
Result<std::vector<Finding>> find_orphans(const std::filesystem::path& store);

}  // namespace engram::ltm
