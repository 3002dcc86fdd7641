// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/store/store_check.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// [{"severity": "fault", "file", "object", "what", "advice"}].
[[nodiscard]] Json findings_json(const std::vector<ltm::Finding>& findings);

/// What a check looked at and found, as `engram check --json` tells it.
[[nodiscard]] Json check_json(const ltm::CheckReport& report, const std::string& store);

/// The same for people.
void print_check(const ltm::CheckReport& report, const std::string& store);

/// A paragraph each, faults first.
void print_findings(const std::vector<ltm::Finding>& findings);

}  // namespace engram::reports
