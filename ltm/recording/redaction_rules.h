// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "ltm/recording/entity_rule.h"
#include "ltm/redaction/redactor.h"

namespace engram::ltm {

/// What redacts snapshots as rules of recording say; null if none of them redacts.
/// Errors: those of Redactor::create.
[[nodiscard]] inline Result<std::unique_ptr<Redactor>> make_redactor(
    const std::vector<EntityRule>& rules) {
  if (std::ranges::none_of(rules, [](const auto& rule) { return rule.redact.has_value(); }))
    return std::unique_ptr<Redactor>();
  std::vector<RedactionRule> redacting;
  for (const EntityRule& rule : rules) redacting.push_back({rule.match, rule.redact});
  return Redactor::create(std::move(redacting));
}

}  // namespace engram::ltm
