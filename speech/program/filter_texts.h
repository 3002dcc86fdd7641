// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the texts of filters mean.

#include <string>
#include <string_view>
#include <vector>

#include "ltm/memory/action_outcome.h"

namespace engram::speech {

/// "salt,tea" as names, of which any fits; empty ones are left out.
[[nodiscard]] std::vector<std::string> names_in_list(std::string_view text);

/// Names as the value of a filter: joined by commas, so that any of them fits.
[[nodiscard]] std::string any_of_names(const std::vector<std::string>& names);

/// Whether an outcome is the one that a filter wants: "success", "lost", or "problem" for a failure
/// or a stop.
[[nodiscard]] bool fits_outcome(std::string_view wanted, ltm::ActionOutcome outcome);

}  // namespace engram::speech
