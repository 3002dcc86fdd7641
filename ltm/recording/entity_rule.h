// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/filter/entity_pattern.h"
#include "ltm/filter/registry.h"

namespace engram::ltm {

/// How matching entities are recorded.
struct EntityRule {
  std::string name;  ///< Its name in reports.
  EntityPattern match;
  std::vector<FilterOptions> filters;  ///< Applied in this order. Empty: everything is kept.
  PackOptions pack;
};

}  // namespace engram::ltm
