// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/seal_rules.h"

#include <vector>

#include "ltm/codec/pack_rule_use.h"

namespace engram::ltm {

struct SealRules::Plan {
  struct Rule {
    PackRule rule;
    PackRuleUse use = PackRuleUse::kSingle;
    std::shared_ptr<const GroupCodec> group;  ///< Only for groups.
  };

  std::vector<Rule> rules;
  /// These paths become columns regardless of the rules.
  std::set<std::string, std::less<>> columns;
};

Result<SealRules> SealRules::create(const PackOptions& options) {
  auto plan = std::make_shared<Plan>();
  bool is_any = false;
  for (const PackRule& rule : options.rules) {
    Plan::Rule& made = plan->rules.emplace_back(Plan::Rule{rule, PackRuleUse::kSingle, nullptr});
    ENGRAM_ASSIGN_OR_RETURN(made.use, use_of(rule));
    is_any = is_any || made.use != PackRuleUse::kSingle;
    if (made.use != PackRuleUse::kGroup) continue;
    ENGRAM_ASSIGN_OR_RETURN(made.group, make_group_codec(rule.codec));
  }
  SealRules rules;
  if (is_any) rules.plan_ = std::move(plan);
  return rules;
}

SealRules SealRules::columns(std::set<std::string, std::less<>> paths) {
  SealRules rules;
  if (!paths.empty()) rules.plan_ = std::make_shared<Plan>(Plan{{}, std::move(paths)});
  return rules;
}

SealRules SealRules::all_columns() {
  auto rules = create({.rules = {{.kind = MediumKind::kNumber, .codec = std::string(kColumns)}}});
  ENGRAM_CHECK(rules.ok(), "{}", rules.status().message());
  return *std::move(rules);
}

const GroupCodec* SealRules::group_codec(std::string_view path, idf::ElementType type,
                                         const idf::Shape& shape) const {
  if (plan_ == nullptr) return nullptr;
  for (const Plan::Rule& each : plan_->rules) {
    if (each.use == PackRuleUse::kNumbers || !matches_path(each.rule.path, path)) continue;
    if (each.rule.kind && *each.rule.kind != medium_kind(type, shape)) continue;
    return each.group != nullptr && each.group->accepts(type, shape) ? each.group.get() : nullptr;
  }
  return nullptr;
}

bool SealRules::are_columns(std::string_view path) const {
  if (plan_ == nullptr) return false;
  if (plan_->columns.contains(path)) return true;
  for (const Plan::Rule& each : plan_->rules)
    if (each.use == PackRuleUse::kNumbers && matches_path(each.rule.path, path))
      return each.rule.codec == kColumns;
  return false;
}

}  // namespace engram::ltm
