// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_config.h"

#include "ltm/core/config.h"
#include "ltm/filter/config_choice.h"
#include "ltm/filter/filter_config.h"

namespace engram::ltm {

namespace {

Result<EntityPattern> read_pattern(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, value.text());
  auto pattern = EntityPattern::parse(text);
  if (!pattern.ok()) return value.error(pattern.status());
  return pattern;
}

constexpr DeprecatedWord kMaxBytesKey{"most_bytes", "max_bytes", "0.3"};
constexpr DeprecatedWord kMinFreeDiskKey{"least_free_disk", "min_free_disk", "0.3"};

/// Sets an optional if the key exists.
template <typename T>
Status read_optional(ConfigMap& map, std::string_view key, std::optional<T>& out,
                     Result<T> (ConfigValue::*as)() const) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(out, ((*value).*as)());
  return {};
}

/// Reads an integer that is at least `min`, if the key exists.
Status read_count(ConfigMap& map, std::string_view key, int64_t min, std::optional<uint64_t>& out) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const int64_t count, value->integer());
  if (count < min) return value->error(fmt::format("found {}, needs {} or more", count, min));
  out = static_cast<uint64_t>(count);
  return {};
}

Result<ImportancePolicy::Options> read_importance(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  ImportancePolicy::Options options;
  ENGRAM_RETURN_IF_ERROR(map.read("path", options.path, &ConfigValue::text));
  ENGRAM_RETURN_IF_ERROR(read_optional(map, "below", options.below, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return options;
}

Result<SaliencyPolicy::Options> read_saliency(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  SaliencyPolicy::Options options;
  ENGRAM_RETURN_IF_ERROR(read_optional(map, "below", options.below, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(read_optional(map, "keep", options.keep, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = options.validate(); !status.ok()) return value.error(status);
  return options;
}

Result<SimilarityFilter::Options> read_redundancy(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  ENGRAM_ASSIGN_OR_RETURN(SimilarityFilter::Options options, read_similarity_options(map));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = options.validate(); !status.ok()) return value.error(status);
  return options;
}

/// Reads the keys of a rule. `age_key` is the one for the age.
Result<ForgetRule> read_rule_keys(ConfigMap& map, std::string_view age_key) {
  ForgetRule rule;
  if (const auto match = map.find("match")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.match, read_pattern(*match));
  }
  AgePolicy::Options age;
  ENGRAM_RETURN_IF_ERROR(read_optional(map, age_key, age.older_than, &ConfigValue::duration));
  // A policy without a bound would propose all snapshots, so a rule has only those that it names.
  if (age.older_than) rule.age = age;
  UnreadPolicy::Options access;
  ENGRAM_RETURN_IF_ERROR(
      read_optional(map, "unread_for", access.unread_for, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(read_count(map, "read_less_than", 1, access.read_less_than));
  if (access.unread_for || access.read_less_than) rule.access = access;
  if (const auto importance = map.find("importance")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.importance, read_importance(*importance));
  }
  if (const auto saliency = map.find("saliency")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.saliency, read_saliency(*saliency));
  }
  if (const auto redundant = map.find("redundant")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.redundancy, read_redundancy(*redundant));
  }
  return rule;
}

Result<ForgetRule> read_rule(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  ENGRAM_ASSIGN_OR_RETURN(ForgetRule rule, read_rule_keys(map, "older_than"));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = rule.validate(); !status.ok()) return value.error(status);
  return rule;
}

/// Reads how far a step fades: `psnr: 32` or `form: gist`.
Status read_fade_target(const ConfigValue& value, ConfigMap& map, FadeStep& step) {
  ENGRAM_RETURN_IF_ERROR(read_optional(map, "psnr", step.psnr_db, &ConfigValue::number));
  const auto form = map.find("form");
  if (!form && step.psnr_db) return {};
  if (!form) return value.error("needs 'psnr' or 'form: gist'");
  ENGRAM_ASSIGN_OR_RETURN(const std::string name, form->text());
  if (name != "gist") return form->error(fmt::format("found '{}', needs 'gist'", name));
  return step.psnr_db ? form->error("a gist has no 'psnr'") : Status();
}

Result<FadeStep> read_fade_step(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  FadeStep step;
  ENGRAM_ASSIGN_OR_RETURN(step.rule, read_rule_keys(map, "after"));
  ENGRAM_RETURN_IF_ERROR(read_fade_target(value, map, step));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (!step.rule.has_policy())
    return value.error(
        "needs 'after', 'unread_for', 'read_less_than', 'importance', 'saliency' or 'redundant'");
  if (const Status status = step.validate(); !status.ok()) return value.error(status);
  return step;
}

Status read_quota(ConfigMap& section, ForgetOptions& options) {
  const auto value = section.find("quota");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
  ENGRAM_RETURN_IF_ERROR(map.read(kMaxBytesKey, options.max_bytes, &ConfigValue::bytes));
  ENGRAM_RETURN_IF_ERROR(
      map.read(kMinFreeDiskKey, options.min_free_disk_bytes, &ConfigValue::bytes));
  ENGRAM_RETURN_IF_ERROR(read_list(map, "first", options.first, read_rule));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (options.max_bytes || options.min_free_disk_bytes) return {};
  return value->error("needs 'max_bytes' or 'min_free_disk'");
}

Status read_protection(ConfigMap& section, ForgetProtection& protection) {
  const auto value = section.find("protect");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
  ENGRAM_RETURN_IF_ERROR(read_list(map, "entities", protection.entities, read_pattern));
  std::optional<uint64_t> newest;
  ENGRAM_RETURN_IF_ERROR(read_count(map, "newest", 0, newest));
  protection.newest = newest.value_or(protection.newest);
  ENGRAM_RETURN_IF_ERROR(
      read_optional(map, "younger_than", protection.younger_than, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.read("linked", protection.linked, &ConfigValue::boolean));
  return map.finish();
}

Result<ForgetOptions> read_options(const ConfigValue& file) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap top, file.map());
  // The recorder reads these (docs/recording.md); finish() would call them unknown.
  for (const char* key : {"preset", "entities", "store", "recording"}) top.find(key);
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue section, top.require("forget"));
  ENGRAM_RETURN_IF_ERROR(top.finish());
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, section.map());
  ForgetOptions options;
  ENGRAM_RETURN_IF_ERROR(read_list(map, "rules", options.rules, read_rule));
  ENGRAM_RETURN_IF_ERROR(read_list(map, "fade", options.fade, read_fade_step));
  ENGRAM_RETURN_IF_ERROR(read_quota(map, options));
  ENGRAM_RETURN_IF_ERROR(read_protection(map, options.protection));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = options.validate(); !status.ok()) return section.error(status);
  return options;
}

}  // namespace

Result<ForgetOptions> parse_forget_config(std::string_view text, const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::parse(text, name));
  return read_options(file);
}

Result<ForgetOptions> read_forget_config(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::read_file(path));
  return read_options(file);
}

}  // namespace engram::ltm
