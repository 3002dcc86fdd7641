// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/likeness/similar_moments.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// A table of the moments that are like another one, nearest first, and what they were compared by.
[[nodiscard]] std::string similar_text(const ltm::SimilarAnswer& answer);

/// {"entity", "space", "compared", "computed", "moments": [{"id", "time_ns", "distance",
/// "recording": {"first_ns", "last_ns"}}]}.
[[nodiscard]] Json similar_json(const ltm::SimilarAnswer& answer);

}  // namespace engram::reports
