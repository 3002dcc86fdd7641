// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/filter_config.h"

#include <array>

#include "ltm/filter/config_choice.h"

namespace engram::ltm {

namespace {

/// Reads a duration, or the word `never` for none.
Status read_duration_or(ConfigMap& map, std::string_view key, std::string_view never,
                        std::optional<Duration>& out) {
  const auto value = map.find(key);
  if (!value) return {};
  if (value->is_text() && *value->text() == never) {
    out.reset();
    return {};
  }
  const auto duration = value->duration();
  if (!duration.ok()) return duration.status().with_context(fmt::format("(or '{}')", never));
  out = *duration;
  return {};
}

Result<NamePattern> read_pattern(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, value.text());
  auto pattern = NamePattern::parse(text);
  if (!pattern.ok()) return value.error(pattern.status());
  return pattern;
}

Result<Measure> read_measure(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string name, value.text());
  if (const auto measure = measure_from_name(name)) return *measure;
  return value.error(fmt::format(
      "unknown measure '{}': needs ignore, equal, mse, mae, max_abs, rms, angle, ssim or cosine",
      name));
}

/// Reads `measure` and `bound` from a map that may hold more keys.
Status read_similarity(ConfigMap& map, Similarity& out) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue measure, map.require("measure"));
  ENGRAM_ASSIGN_OR_RETURN(out.measure, read_measure(measure));
  if (out.measure != Measure::kIgnore && out.measure != Measure::kEqual) {
    ENGRAM_ASSIGN_OR_RETURN(const ConfigValue bound, map.require("bound"));
    ENGRAM_ASSIGN_OR_RETURN(out.bound, bound.number());
  }
  if (const Status status = out.validate(); !status.ok()) return map.value().error(status);
  return {};
}

Status read_similarity_of(ConfigMap& map, std::string_view key, Similarity& out) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap inner, value->map());
  ENGRAM_RETURN_IF_ERROR(read_similarity(inner, out));
  return inner.finish();
}

Result<SimilarityFilter::MemberRule> read_member(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  SimilarityFilter::MemberRule rule;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue path, map.require("path"));
  ENGRAM_ASSIGN_OR_RETURN(rule.path, read_pattern(path));
  ENGRAM_RETURN_IF_ERROR(read_similarity(map, rule.similarity));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return rule;
}

Result<Telling> read_telling(const ConfigValue& value) {
  return choice_of(value, std::array<Choice<Telling>, 5>{{{"failure", Telling::kFailure},
                                                          {"stop", Telling::kStop},
                                                          {"success", Telling::kSuccess},
                                                          {"speech", Telling::kSpeech},
                                                          {"links", Telling::kLinks}}});
}

Result<EventRule> read_event(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  EventRule rule;
  if (const auto entity = map.find("entity")) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, entity->text());
    auto pattern = EntityPattern::parse(text);
    if (!pattern.ok()) return entity->error(pattern.status());
    rule.entity = *std::move(pattern);
  }
  ENGRAM_RETURN_IF_ERROR(map.read("path", rule.path, &ConfigValue::text));
  if (!rule.path.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const ConfigValue bound, map.require("bound"));
    ENGRAM_ASSIGN_OR_RETURN(rule.bound, bound.number());
    ENGRAM_RETURN_IF_ERROR(
        read_choice(map, "crosses", rule.crossing,
                    std::array<Choice<Crossing>, 3>{{{"rising", Crossing::kRising},
                                                     {"falling", Crossing::kFalling},
                                                     {"either", Crossing::kEither}}}));
  }
  ENGRAM_RETURN_IF_ERROR(read_list(map, "tells", rule.tells, read_telling));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = rule.validate(); !status.ok()) return value.error(status);
  return rule;
}

Result<FilterOptions> read_frequency(ConfigMap& map) {
  FrequencyFilter::Options options;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue rate, map.require("rate"));
  ENGRAM_ASSIGN_OR_RETURN(options.max_rate_hz, rate.rate_hz());
  return FilterOptions(options);
}

Result<FilterOptions> read_equality(ConfigMap& map) {
  EqualityFilter::Options options;
  ENGRAM_RETURN_IF_ERROR(read_duration_or(map, "max_gap", "never", options.max_gap));
  return FilterOptions(options);
}

Result<FilterOptions> read_similarity_filter(ConfigMap& map) {
  ENGRAM_ASSIGN_OR_RETURN(SimilarityFilter::Options options, read_similarity_options(map));
  return FilterOptions(std::move(options));
}

Result<FilterOptions> read_importance(ConfigMap& map) {
  ImportanceFilter::Options options;
  ENGRAM_RETURN_IF_ERROR(read_list(map, "events", options.events, read_event));
  ENGRAM_RETURN_IF_ERROR(map.read("before", options.before, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.read("after", options.after, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.read("base_rate", options.base_rate_hz, &ConfigValue::rate_hz));
  ENGRAM_RETURN_IF_ERROR(map.read("hold_limit", options.max_held_bytes, &ConfigValue::bytes));
  return FilterOptions(std::move(options));
}

Result<FilterOptions> read_trigger(ConfigMap& map) {
  TriggerFilter::Options options;
  ENGRAM_RETURN_IF_ERROR(read_list(map, "events", options.events, read_event));
  ENGRAM_RETURN_IF_ERROR(map.read("before", options.before, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(read_duration_or(map, "after", "forever", options.after));
  ENGRAM_RETURN_IF_ERROR(map.read("hold_limit", options.max_held_bytes, &ConfigValue::bytes));
  return FilterOptions(std::move(options));
}

struct FilterReader {
  std::string_view name;
  Result<FilterOptions> (*read)(ConfigMap&);
};
constexpr std::array<FilterReader, std::variant_size_v<FilterOptions>> kReaders{
    {{"frequency", read_frequency},
     {"equality", read_equality},
     {"similarity", read_similarity_filter},
     {"importance", read_importance},
     {"trigger", read_trigger}}};

/// The reader of a filter by its name. `at` is the place that an error names.
Result<const FilterReader*> find_reader(const ConfigValue& at, std::string_view name) {
  std::vector<std::string> known;
  for (const FilterReader& reader : kReaders) {
    if (reader.name == name) return &reader;
    known.emplace_back(reader.name);
  }
  const auto closest = closest_word(name, known);
  return at.error(
      closest ? fmt::format("unknown filter '{}'; did you mean '{}'?", name, *closest)
              : fmt::format("unknown filter '{}': needs one of {}", name, fmt::join(known, ", ")));
}

/// Reads one filter: a name alone (`equality`) or with options (`frequency: {rate: 5Hz}`).
Result<FilterOptions> read_filter(const ConfigValue& value) {
  if (value.is_text()) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string name, value.text());
    ENGRAM_ASSIGN_OR_RETURN(const FilterReader* reader, find_reader(value, name));
    // A name alone is read as a filter with an empty map, so a missing option is found as usual.
    ENGRAM_ASSIGN_OR_RETURN(const ConfigValue none, ConfigValue::parse("", "options"));
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, none.map());
    auto options = reader->read(map);
    const Status status = options.ok() ? validate(*options) : options.status();
    if (!status.ok()) return value.error(fmt::format("filter '{}' needs options", name));
    return options;
  }
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap outer, value.map());
  const std::vector<std::string> names = outer.keys();
  if (names.size() != 1)
    return value.error(
        fmt::format("found {} keys, needs the name of one filter, as in 'frequency: {{rate: 5Hz}}'",
                    names.size()));
  ENGRAM_ASSIGN_OR_RETURN(const FilterReader* reader, find_reader(value, names.front()));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue inner, outer.require(names.front()));
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, inner.map());
  ENGRAM_ASSIGN_OR_RETURN(FilterOptions options, reader->read(map));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = validate(options); !status.ok()) return inner.error(status);
  return options;
}

}  // namespace

Result<std::vector<FilterOptions>> read_filters(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const auto values, value.list());
  std::vector<FilterOptions> filters;
  for (const ConfigValue& each : values) {
    ENGRAM_ASSIGN_OR_RETURN(FilterOptions options, read_filter(each));
    filters.push_back(std::move(options));
  }
  return filters;
}

Result<SimilarityFilter::Options> read_similarity_options(ConfigMap& map) {
  SimilarityFilter::Options options;
  ENGRAM_RETURN_IF_ERROR(read_list(map, "members", options.members, read_member));
  ENGRAM_RETURN_IF_ERROR(read_similarity_of(map, "images", options.images));
  ENGRAM_RETURN_IF_ERROR(read_similarity_of(map, "numbers", options.numbers));
  ENGRAM_RETURN_IF_ERROR(read_similarity_of(map, "orientations", options.orientations));
  ENGRAM_RETURN_IF_ERROR(
      read_choice(map, "remainder", options.compares_remainder,
                  std::array<Choice<bool>, 2>{{{"equal", true}, {"ignore", false}}}));
  ENGRAM_RETURN_IF_ERROR(read_duration_or(map, "max_gap", "never", options.max_gap));
  return options;
}

}  // namespace engram::ltm
