// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/filter/entity_pattern.h"
#include "ltm/filter/registry.h"

namespace engram::ltm {

/// How the entities that match are recorded.
struct EntityRule {
  std::string name;  ///< What reports call it.
  EntityPattern match;
  std::vector<FilterOptions> filters;  ///< One behind the other. None: all is kept.
  PackOptions pack;
};

}  // namespace engram::ltm
