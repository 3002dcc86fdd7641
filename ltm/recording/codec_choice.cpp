// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/codec_choice.h"

#include <algorithm>
#include <vector>

#include "ltm/codec/group_codec.h"

namespace engram::ltm {

namespace {

/// Returns one copy of the rule for each codec of a list.
Result<std::vector<PackRule>> rules_with(const std::vector<ConfigValue>& codecs,
                                         const PackRule& rule) {
  std::vector<PackRule> rules(codecs.size(), rule);
  std::vector<bool> are_groups(codecs.size());
  for (size_t i = 0; i < codecs.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(rules[i].codec, codecs[i].text());
    const auto is_group = means_groups(rules[i].codec);
    if (!is_group.ok()) return codecs[i].error(is_group.status());
    are_groups[i] = *is_group;
  }
  const bool has_groups = std::ranges::count(are_groups, true) > 0;
  for (size_t i = 0; i < rules.size(); ++i)
    if (has_groups && !are_groups[i]) rules[i].journal.clear();
  return rules;
}

}  // namespace

Result<PackRule> choose_codec(const ConfigValue& codec, const PackRule& rule,
                              const CodecCheck& check) {
  std::vector<ConfigValue> codecs{codec};
  if (codec.is_list()) {
    ENGRAM_ASSIGN_OR_RETURN(codecs, codec.list());
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto rules, rules_with(codecs, rule));
  Status missing = codec.error("found no codec, needs one or more");
  const PackRule* chosen = nullptr;
  for (size_t i = 0; i < rules.size(); ++i) {
    const Status status = check(rules[i]);
    if (!status.ok() && status.code() != StatusCode::kFailedPrecondition)
      return codecs[i].error(status);
    if (!status.ok()) missing = codecs[i].error(status);
    if (status.ok() && chosen == nullptr) chosen = &rules[i];
  }
  return chosen == nullptr ? Result<PackRule>(missing) : *chosen;
}

}  // namespace engram::ltm
