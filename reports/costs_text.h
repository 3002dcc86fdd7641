// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "reports/plain/output.h"
#include "training/night/entity_costs.h"

namespace engram::reports {

/// One line on where the processor time went and, with images, one on how often they were encoded.
/// There are none if nothing was measured.
[[nodiscard]] std::vector<std::string> costs_text(const training::EntityCosts& costs);

/// Every stage by name with its "processor_seconds" (of all threads) and "seconds" (by the clock).
[[nodiscard]] Json stages_json(const training::StageTimes& stages);

/// Null without images.
[[nodiscard]] Json encodes_json(const training::EntityCosts& costs);

}  // namespace engram::reports
