// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/store/recover.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Reports what of a store was saved, what was lost, and why.
[[nodiscard]] Json recover_json(const ltm::RecoverReport& report, const std::string& source,
                                const std::string& target);
void print_recovered(const ltm::RecoverReport& report, const std::string& target);

}  // namespace engram::reports
