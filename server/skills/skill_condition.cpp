// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_condition.h"

#include <re2/re2.h>

#include <algorithm>
#include <array>

#include "ltm/filter/config_choice.h"
#include "ltm/filter/entity_pattern.h"
#include "ltm/memory/answered_snapshots.h"
#include "ltm/memory/memory_id.h"

namespace engram::skills {

namespace {

using ltm::Choice;
using ltm::Crossing;
using ltm::Telling;

constexpr std::array<Choice<Crossing>, 3> kCrossings{{{"rising", Crossing::kRising},
                                                      {"falling", Crossing::kFalling},
                                                      {"either", Crossing::kEither}}};
constexpr std::array<Choice<Telling>, 5> kTellings{{{"failure", Telling::kFailure},
                                                    {"stop", Telling::kStop},
                                                    {"success", Telling::kSuccess},
                                                    {"speech", Telling::kSpeech},
                                                    {"links", Telling::kLinks}}};

bool names_parameter(std::string_view text) {
  return text.size() > 1 && text.front() == '$';
}

template <typename T, size_t N>
std::string_view word_of(T value, const std::array<Choice<T>, N>& choices) {
  for (const Choice<T>& choice : choices)
    if (choice.value == value) return choice.word;
  return "";
}

/// A scalar as the value that it looks like; quotes make a text of it.
Result<idf::Data> scalar_of(const ConfigValue& value) {
  if (!value.is_quoted()) {
    if (const auto flag = value.boolean(); flag.ok()) return idf::Data(*flag);
    if (const auto number = value.number(); number.ok()) return idf::Data(*number);
  }
  ENGRAM_ASSIGN_OR_RETURN(std::string text, value.text());
  return idf::Data(std::move(text));
}

Result<Telling> read_told(const ConfigValue& value) {
  return ltm::choice_of(value, kTellings);
}

Status read_entity(ConfigMap& map, ConditionLeaf& leaf) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue entity, map.require("entity"));
  ENGRAM_ASSIGN_OR_RETURN(leaf.entity, entity.text());
  if (names_parameter(leaf.entity)) return {};
  const auto pattern = ltm::EntityPattern::parse(leaf.entity);
  return pattern.ok() ? Status() : entity.error(pattern.status());
}

/// What is asked of the value at the path.
Status read_predicate(ConfigMap& map, ConditionLeaf& leaf) {
  ENGRAM_RETURN_IF_ERROR(map.read("path", leaf.path, &ConfigValue::text));
  if (const auto bound = map.find("bound")) {
    ENGRAM_ASSIGN_OR_RETURN(leaf.bound, bound->number());
  }
  ENGRAM_RETURN_IF_ERROR(ltm::read_choice(map, "crosses", leaf.crossing, kCrossings));
  if (const auto equals = map.find("equals")) {
    ENGRAM_ASSIGN_OR_RETURN(leaf.equals, scalar_of(*equals));
  }
  if (const auto matches = map.find("matches")) {
    ENGRAM_ASSIGN_OR_RETURN(leaf.matches, matches->text());
    const re2::RE2 expression(leaf.matches, re2::RE2::Quiet);
    if (!expression.ok())
      return matches->error(fmt::format("found '{}', needs a regular expression: {}", leaf.matches,
                                        expression.error()));
  }
  ENGRAM_RETURN_IF_ERROR(ltm::read_list(map, "tells", leaf.tells, read_told));
  const int asked = (leaf.bound ? 1 : 0) + (leaf.equals ? 1 : 0) + (leaf.matches.empty() ? 0 : 1) +
                    (leaf.tells.empty() ? 0 : 1);
  if (asked > 1)
    return map.value().error("found several of bound, equals, matches and tells, needs one");
  if (leaf.path.empty() && (leaf.bound || leaf.equals || !leaf.matches.empty()))
    return map.value().error("needs a 'path' beside what the value there must be");
  if (!leaf.path.empty() && asked == 0)
    return map.value().error("needs one of bound, equals and matches beside 'path'");
  if (!leaf.path.empty() && !leaf.tells.empty())
    return map.value().error("found 'path' and 'tells', needs one of them");
  if (leaf.crossing == Crossing::kEither && !leaf.is_new)
    return map.value().error("'crosses: either' is a moment: it needs 'new: true'");
  return {};
}

Result<Condition> read_leaf(ConfigMap& map) {
  Condition condition{.kind = Condition::Kind::kLeaf};
  ConditionLeaf& leaf = condition.leaf;
  ENGRAM_RETURN_IF_ERROR(read_entity(map, leaf));
  ENGRAM_RETURN_IF_ERROR(map.read("new", leaf.is_new, &ConfigValue::boolean));
  ENGRAM_RETURN_IF_ERROR(read_predicate(map, leaf));
  // What a snapshot tells is news, as it is for event rules.
  if (!leaf.tells.empty()) leaf.is_new = true;
  ENGRAM_RETURN_IF_ERROR(map.read("max_age", leaf.max_age, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.read("binds", leaf.binds, &ConfigValue::text));
  return condition;
}

Result<std::vector<Condition>> read_parts(const ConfigValue& list) {
  ENGRAM_ASSIGN_OR_RETURN(const auto values, list.list());
  std::vector<Condition> parts;
  for (const ConfigValue& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(Condition part, read_condition(value));
    parts.push_back(std::move(part));
  }
  return parts;
}

std::string predicate_text(const ConditionLeaf& leaf) {
  if (leaf.bound) {
    if (leaf.is_new)
      return fmt::format("{} crosses {} {}", leaf.path, *leaf.bound,
                         word_of(leaf.crossing, kCrossings));
    return fmt::format("{} is {} {}", leaf.path,
                       leaf.crossing == Crossing::kFalling ? "below" : "at least", *leaf.bound);
  }
  if (leaf.equals) {
    const auto* text = leaf.equals->get_if<std::string>();
    const auto number = leaf.equals->as_number();
    const auto* flag = leaf.equals->get_if<bool>();
    return fmt::format("{} equals {}", leaf.path,
                       flag != nullptr   ? (*flag ? "true" : "false")
                       : text != nullptr ? "'" + *text + "'"
                                         : fmt::format("{}", number.value_or(0)));
  }
  if (!leaf.matches.empty()) return fmt::format("{} matches '{}'", leaf.path, leaf.matches);
  if (leaf.tells.empty()) return leaf.is_new ? "comes" : "is there";
  std::vector<std::string_view> told;
  for (const Telling telling : leaf.tells) told.push_back(word_of(telling, kTellings));
  return fmt::format("tells {}", fmt::join(told, " or "));
}

std::string leaf_text(const ConditionLeaf& leaf) {
  std::string text = leaf.entity + ": " + predicate_text(leaf);
  if (leaf.is_new && leaf.tells.empty() && !leaf.path.empty() && !leaf.bound) text += ", newly";
  if (leaf.max_age) text += fmt::format(", at most {} old", engram::to_string(*leaf.max_age));
  return text;
}

void add_leaves(const Condition& condition, std::vector<const ConditionLeaf*>& leaves) {
  if (condition.kind == Condition::Kind::kLeaf) leaves.push_back(&condition.leaf);
  for (const Condition& part : condition.parts) add_leaves(part, leaves);
}

Result<std::string> parameter_text(const std::string& name, const idf::Data& parameters) {
  const idf::Data* value = parameters.at(idf::join_path("", name.substr(1)));
  if (value == nullptr)
    return invalid_argument("condition: found {}, but there is no such parameter", name);
  const auto* text = value->get_if<std::string>();
  if (text == nullptr)
    return invalid_argument("condition: {} is {}, needs a text or a link", name,
                            value->kind_name());
  return *text;
}

/// The names of an entity as a pattern that matches it alone.
Result<std::string> exact_pattern(const std::string& link, const std::string& parameter) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, ltm::MemoryId::parse(link));
  if (!id.has_entity())
    return invalid_argument("condition: {} is '{}', needs an entity", parameter, link);
  return ltm::exact_names(id);
}

Status fill_in(Condition& condition, const idf::Data& parameters) {
  ConditionLeaf& leaf = condition.leaf;
  if (names_parameter(leaf.entity)) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string link, parameter_text(leaf.entity, parameters));
    ENGRAM_ASSIGN_OR_RETURN(leaf.entity, exact_pattern(link, leaf.entity));
  }
  if (leaf.equals)
    if (const auto* text = leaf.equals->get_if<std::string>(); text && names_parameter(*text)) {
      ENGRAM_ASSIGN_OR_RETURN(leaf.equals, parameter_text(std::string(*text), parameters));
    }
  for (Condition& part : condition.parts) ENGRAM_RETURN_IF_ERROR(fill_in(part, parameters));
  return {};
}

}  // namespace

Result<Condition> read_condition(const ConfigValue& value) {
  Condition condition;
  if (value.is_list()) {
    ENGRAM_ASSIGN_OR_RETURN(condition.parts, read_parts(value));
    return condition;
  }
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  const auto all = map.find("all");
  const auto any = map.find("any");
  const auto inverted = map.find("not");
  if ((all ? 1 : 0) + (any ? 1 : 0) + (inverted ? 1 : 0) > 1)
    return value.error("found several of all, any and not, needs one");
  if (all || any) {
    condition.kind = all ? Condition::Kind::kAll : Condition::Kind::kAny;
    ENGRAM_ASSIGN_OR_RETURN(condition.parts, read_parts(all ? *all : *any));
    if (condition.parts.empty()) return value.error("found an empty list, needs conditions");
  } else if (inverted) {
    condition.kind = Condition::Kind::kNot;
    ENGRAM_ASSIGN_OR_RETURN(Condition part, read_condition(*inverted));
    condition.parts.push_back(std::move(part));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(condition, read_leaf(map));
  }
  ENGRAM_RETURN_IF_ERROR(map.read("for", condition.holds_for, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (condition.leaf.is_new && condition.holds_for > Duration(0))
    return value.error("a snapshot that is new is a moment: it cannot hold 'for' a time");
  if (leaves_of(condition).size() > Condition::kMaxLeaves)
    return value.error(fmt::format("found more than {} conditions", Condition::kMaxLeaves));
  return condition;
}

std::string to_string(const Condition& condition) {
  std::string text;
  if (condition.kind == Condition::Kind::kLeaf) {
    text = leaf_text(condition.leaf);
  } else {
    std::vector<std::string> parts;
    for (const Condition& part : condition.parts) parts.push_back(to_string(part));
    const std::string_view joint = condition.kind == Condition::Kind::kAny ? " or " : " and ";
    text = fmt::format("{}({})", condition.kind == Condition::Kind::kNot ? "not " : "",
                       fmt::join(parts, joint));
  }
  if (condition.holds_for > Duration(0))
    text += fmt::format(", for {}", engram::to_string(condition.holds_for));
  return text;
}

std::vector<const ConditionLeaf*> leaves_of(const Condition& condition) {
  std::vector<const ConditionLeaf*> leaves;
  add_leaves(condition, leaves);
  return leaves;
}

std::set<std::string> parameters_in(const Condition& condition) {
  std::set<std::string> names;
  for (const ConditionLeaf* leaf : leaves_of(condition)) {
    if (names_parameter(leaf->entity)) names.insert(leaf->entity.substr(1));
    if (!leaf->equals) continue;
    const auto* text = leaf->equals->get_if<std::string>();
    if (text != nullptr && names_parameter(*text)) names.insert(text->substr(1));
  }
  return names;
}

Result<Condition> with_parameters(const Condition& condition, const idf::Data& parameters) {
  Condition filled = condition;
  ENGRAM_RETURN_IF_ERROR(fill_in(filled, parameters));
  return filled;
}

}  // namespace engram::skills
