// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cli/command.h"
#include "ltm/store/finding.h"

namespace engram::cli {

/// [{"severity": "fault", "file", "object", "what", "advice"}].
[[nodiscard]] Json findings_json(const std::vector<ltm::Finding>& findings);

/// A paragraph each, faults first.
void print_findings(const std::vector<ltm::Finding>& findings);

}  // namespace engram::cli
