// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/filter/entity_pattern.h"
#include "ltm/filter/registry.h"
#include "ltm/memory/ahead_limits.h"
#include "ltm/redaction/redaction_options.h"

namespace engram::ltm {

/// How matching entities are recorded.
struct EntityRule {
  std::string name;  ///< Its name in reports.
  EntityPattern match;
  std::vector<FilterOptions> filters;  ///< Applied in this order. Empty: everything is kept.
  /// How long what filters dropped is held, and kept after all if something that is kept links to
  /// it. Empty: not at all.
  std::optional<Duration> keep_linked{};
  /// How far ahead of the clock times may lie; empty: as for all entities. AheadLimits::kNone: any.
  std::optional<Duration> max_ahead;
  /// How their images are redacted, ahead of filters; empty: not at all.
  std::optional<RedactionOptions> redact;
  PackOptions pack;
};

}  // namespace engram::ltm
