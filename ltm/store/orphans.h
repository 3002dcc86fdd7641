// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/store/finding.h"

namespace engram::ltm {

/// Finds files of a store that no reader uses: files left by killed processes, sealed journals, and
/// damaged journals that are kept for inspection. Returns one note for each.
/// Errors: those of read_manifest; kUnavailable.
Result<std::vector<Finding>> find_orphans(const std::filesystem::path& store);

}  // namespace engram::ltm
