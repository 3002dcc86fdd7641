// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/config.h"
#include "ltm/filter/registry.h"

namespace engram::ltm {

/// Reads the list of filters of one rule.
/// Errors: kInvalidArgument naming file, line and key.
/// Source: docs/recording.md, section "Filters".
Result<std::vector<FilterOptions>> read_filters(const ConfigValue& value);

/// Reads the options of a similarity filter. The caller reads what else the map may hold, finishes
/// the map and validates the options.
/// Errors: as above.
Result<SimilarityFilter::Options> read_similarity_options(ConfigMap& map);

}  // namespace engram::ltm
