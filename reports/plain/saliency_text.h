// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/saliency/salient_moment.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// A table of what makes a snapshot salient, the greatest contribution first.
[[nodiscard]] std::string saliency_text(const ltm::SalientMoment& moment);

/// {"id", "time_ns", "saliency", "rank", "of", "is_stored", "learned_from", "parts": [{"part",
/// "value", "weight", "contribution", "found", "expected"}]}.
[[nodiscard]] Json saliency_json(const ltm::SalientMoment& moment);

}  // namespace engram::reports
