// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/entity_seal_rules.h"

#include <utility>

namespace engram::ltm {

SealRulesOf seal_rules_of(const Recorder::Options& options) {
  struct Rules {
    std::vector<std::pair<EntityPattern, SealRules>> by_pattern;
    SealRules otherwise;
  };
  const auto made = [](const PackOptions& pack) {
    auto rules = SealRules::create(pack);
    ENGRAM_CHECK(rules.ok(), "{}", rules.status().message());
    return *std::move(rules);
  };
  auto rules = std::make_shared<Rules>();
  rules->otherwise = made(options.pack);
  bool is_any = !rules->otherwise.empty();
  for (const EntityRule& rule : options.rules) {
    rules->by_pattern.emplace_back(rule.match, made(rule.pack));
    is_any = is_any || !rules->by_pattern.back().second.empty();
  }
  if (!is_any) return {};
  return [rules = std::shared_ptr<const Rules>(std::move(rules))](const MemoryId& entity) {
    for (const auto& [pattern, of_pattern] : rules->by_pattern)
      if (pattern.matches(entity)) return of_pattern;
    return rules->otherwise;
  };
}

}  // namespace engram::ltm
