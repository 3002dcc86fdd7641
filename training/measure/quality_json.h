// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "training/measure/prediction_quality.h"

// Private to this room.

namespace engram::training {

/// NaN and infinity become null.
[[nodiscard]] nlohmann::ordered_json number_json(double value);
[[nodiscard]] nlohmann::ordered_json quality_json(const Quality& quality);
/// Only the kinds for which something was predicted.
[[nodiscard]] nlohmann::ordered_json bound_coverage_json(const BoundCoverage& bound_coverage);

}  // namespace engram::training
