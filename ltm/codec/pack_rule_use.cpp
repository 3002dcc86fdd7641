// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/pack_rule_use.h"

#include <fmt/ranges.h>

#include <set>

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"
#include "ltm/codec/group_codec.h"

namespace engram::ltm {

namespace {

/// Names of the codecs for single arrays and for groups, each once.
std::string known_codecs() {
  std::set<std::string_view> names(group_codec_names().begin(), group_codec_names().end());
  for (const Codec* codec : all_codecs()) names.insert(codec->name());
  return fmt::format("{}", fmt::join(names, ", "));
}

Status check_single(const PackRule& rule) {
  ENGRAM_ASSIGN_OR_RETURN(const CodecText parsed, CodecText::parse(rule.codec));
  if (find_codec(parsed.name()) != nullptr) return {};
  return invalid_argument("unknown codec '{}', needs one of: {}; or '{}'", parsed.name(),
                          known_codecs(), kStays);
}

Status check_numbers(const PackRule& rule) {
  if (rule.codec != kColumns && rule.codec != kStays)
    return invalid_argument("codec '{}': is not for numbers, these need '{}' or '{}'", rule.codec,
                            kColumns, kStays);
  return {};
}

Status check_group(const PackRule& rule) {
  if (rule.kind == MediumKind::kCloud || rule.kind == MediumKind::kArray)
    return invalid_argument("codec '{}': is for images, found arrays of another kind", rule.codec);
  if (rule.journal.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto journal, make_codec(rule.journal));
  if (journal->is_lossless()) return {};
  return invalid_argument("journal codec '{}': has loss, what is sealed as '{}' needs one without",
                          rule.journal, rule.codec);
}

}  // namespace

Result<PackRuleUse> use_of(const PackRule& rule) {
  const bool is_numbers = rule.kind == MediumKind::kNumber;
  if (!is_numbers && rule.codec == kColumns)
    return invalid_argument("codec '{}': is for numbers, needs kind: number", rule.codec);
  bool is_group = false;
  if (!is_numbers && rule.codec != kStays) {
    ENGRAM_ASSIGN_OR_RETURN(is_group, means_groups(rule.codec));
  }
  if (!is_group && !rule.journal.empty())
    return invalid_argument("journal codec '{}': codec '{}' is that of the journal already",
                            rule.journal, rule.codec);
  if (!is_numbers && !is_group && rule.codec != kStays) ENGRAM_RETURN_IF_ERROR(check_single(rule));
  if (is_numbers) ENGRAM_RETURN_IF_ERROR(check_numbers(rule));
  if (is_group) ENGRAM_RETURN_IF_ERROR(check_group(rule));
  return is_numbers ? PackRuleUse::kNumbers
                    : (is_group ? PackRuleUse::kGroup : PackRuleUse::kSingle);
}

}  // namespace engram::ltm
