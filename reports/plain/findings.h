// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/store/store_check.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// A list of objects: [{"severity": "fault", "file", "object", "what", "advice"}].
[[nodiscard]] Json findings_json(const std::vector<ltm::Finding>& findings);

/// Reports what a check has examined and found, as `engram check --json` prints it.
[[nodiscard]] Json check_json(const ltm::CheckReport& report, const std::string& store);

/// Prints the same for people.
void print_check(const ltm::CheckReport& report, const std::string& store);

/// Prints a paragraph per finding, faults first.
void print_findings(const std::vector<ltm::Finding>& findings);

}  // namespace engram::reports
