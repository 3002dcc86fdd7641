// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/recording_config.h"

#include <array>
#include <utility>

#include "ltm/core/config.h"
#include "ltm/filter/config_choice.h"
#include "ltm/filter/filter_config.h"
#include "ltm/recording/codec_choice.h"
#include "ltm/redaction/redaction_config.h"

namespace engram::ltm {

namespace {

Result<std::optional<MediumKind>> read_kind(ConfigMap& map) {
  if (!map.find("kind")) return std::optional<MediumKind>();
  MediumKind kind{};
  ENGRAM_RETURN_IF_ERROR(
      read_choice(map, "kind", kind,
                  std::array<Choice<MediumKind>, 5>{{{"image", MediumKind::kImage},
                                                     {"depth", MediumKind::kDepth},
                                                     {"cloud", MediumKind::kCloud},
                                                     {"array", MediumKind::kArray},
                                                     {"number", MediumKind::kNumber}}}));
  return std::optional(kind);
}

Result<PackRule> read_codec(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  PackRule rule;
  ENGRAM_RETURN_IF_ERROR(map.read("path", rule.path, &ConfigValue::text));
  ENGRAM_ASSIGN_OR_RETURN(rule.kind, read_kind(map));
  ENGRAM_RETURN_IF_ERROR(map.read("journal", rule.journal, &ConfigValue::text));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue codec, map.require("codec"));
  ENGRAM_ASSIGN_OR_RETURN(rule, choose_codec(codec, rule, [](const PackRule& chosen) {
                            return PackOptions{.rules = {chosen}}.validate();
                          }));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return rule;
}

Status read_codecs(ConfigMap& map, PackOptions& pack) {
  const auto value = map.find("codecs");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto values, value->list());
  for (const ConfigValue& each : values) {
    ENGRAM_ASSIGN_OR_RETURN(PackRule rule, read_codec(each));
    pack.rules.push_back(std::move(rule));
  }
  return {};
}

Result<EntityRule> read_rule(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  EntityRule rule;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue match, map.require("match"));
  ENGRAM_ASSIGN_OR_RETURN(rule.name, match.text());
  auto pattern = EntityPattern::parse(rule.name);
  if (!pattern.ok()) return match.error(pattern.status());
  rule.match = *std::move(pattern);
  ENGRAM_RETURN_IF_ERROR(map.read("name", rule.name, &ConfigValue::text));
  if (const auto filters = map.find("filters")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.filters, read_filters(*filters));
  }
  if (const auto linked = map.find("keep_linked")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.keep_linked, linked->duration());
  }
  if (const auto redact = map.find("redact")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.redact, read_redaction(*redact));
  }
  if (const auto ahead = map.find("max_ahead")) {
    ENGRAM_ASSIGN_OR_RETURN(rule.max_ahead, ahead->duration_or_never());
  }
  ENGRAM_RETURN_IF_ERROR(read_codecs(map, rule.pack));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return rule;
}

/// Puts the file's rules before those of the preset. The first rule that matches counts, so the
/// file's rules override the preset.
Status read_entities(ConfigMap& top, Recorder::Options& options) {
  const auto value = top.find("entities");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto values, value->list());
  std::vector<EntityRule> rules;
  for (const ConfigValue& each : values) {
    ENGRAM_ASSIGN_OR_RETURN(EntityRule rule, read_rule(each));
    rules.push_back(std::move(rule));
  }
  options.rules.insert(options.rules.begin(), std::make_move_iterator(rules.begin()),
                       std::make_move_iterator(rules.end()));
  return {};
}

Status read_store(ConfigMap& top, StoreWriter::Options& store) {
  const auto value = top.find("store");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
  ENGRAM_RETURN_IF_ERROR(
      read_choice(map, "durability", store.durability,
                  std::array<Choice<Durability>, 3>{{{"every", Durability::kEvery},
                                                     {"interval", Durability::kInterval},
                                                     {"none", Durability::kNone}}}));
  ENGRAM_RETURN_IF_ERROR(map.read("sync_interval", store.sync_interval, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.read("seal_size", store.seal_bytes, &ConfigValue::bytes));
  ENGRAM_RETURN_IF_ERROR(map.read("seal_after", store.seal_after, &ConfigValue::duration));
  return map.finish();
}

Status read_recording(ConfigMap& top, Recorder::Options& options) {
  const auto value = top.find("recording");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
  int64_t threads = options.threads;
  ENGRAM_RETURN_IF_ERROR(map.read("threads", threads, &ConfigValue::integer));
  // validate() checks it too, but this error names the line, and the cast below cannot overflow.
  if (threads < 1 || threads > Recorder::kMaxThreads)
    return map.find("threads")->error(
        fmt::format("found {}, needs 1 to {}", threads, Recorder::kMaxThreads));
  options.threads = static_cast<int>(threads);
  ENGRAM_RETURN_IF_ERROR(
      read_choice(map, "late", options.late,
                  std::array<Choice<LateSnapshots>, 2>{
                      {{"keep", LateSnapshots::kKeep}, {"refuse", LateSnapshots::kRefuse}}}));
  ENGRAM_RETURN_IF_ERROR(map.read("max_ahead", options.max_ahead, &ConfigValue::duration_or_never));
  ENGRAM_RETURN_IF_ERROR(
      map.read("drop_note_interval", options.drop_note_interval, &ConfigValue::duration));
  return map.finish();
}

Result<Recorder::Options> read_options(const ConfigValue& file);

Result<Recorder::Options> base_of(ConfigMap& top) {
  const auto preset = top.find("preset");
  if (!preset) return Recorder::Options();
  ENGRAM_ASSIGN_OR_RETURN(const std::string name, preset->text());
  const auto yaml = recording_preset(name);
  if (!yaml.ok()) return preset->error(yaml.status());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue base,
                          ConfigValue::parse(*yaml, fmt::format("preset '{}'", name)));
  return read_options(base);
}

Result<Recorder::Options> read_options(const ConfigValue& file) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap top, file.map());
  ENGRAM_ASSIGN_OR_RETURN(Recorder::Options options, base_of(top));
  ENGRAM_RETURN_IF_ERROR(read_entities(top, options));
  ENGRAM_RETURN_IF_ERROR(read_store(top, options.store));
  ENGRAM_RETURN_IF_ERROR(read_recording(top, options));
  top.find("forget");  // ltm/forgetting reads it; finish() would call it unknown.
  ENGRAM_RETURN_IF_ERROR(top.finish());
  if (const Status status = options.validate(); !status.ok()) return file.error(status);
  return options;
}

}  // namespace

Result<Recorder::Options> parse_recording_config(std::string_view text, const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::parse(text, name));
  return read_options(file);
}

Result<Recorder::Options> read_recording_config(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::read_file(path));
  return read_options(file);
}

}  // namespace engram::ltm
