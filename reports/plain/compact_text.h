// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/store/rewrite.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Reports what joining segments has changed.
[[nodiscard]] Json compact_json(const ltm::RewriteReport& report);
[[nodiscard]] std::string compact_text(const ltm::RewriteReport& report);

}  // namespace engram::reports
