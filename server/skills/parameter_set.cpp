// SPDX-License-Identifier: Apache-2.0
#include "server/skills/parameter_set.h"

#include <algorithm>
#include <map>

#include "ltm/filter/config_choice.h"
#include "ltm/idf/cast.h"

namespace engram::skills {

namespace {

using idf::Data;
using idf::ElementType;
using idf::Type;

/// The types that a parameter may have, with the words for them.
Result<Type> parameter_type(const ConfigValue& value, const idf::Quantity& quantity) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string word, value.text());
  if (word == "bool") return Type::boolean();
  // Of 64 bits, which JSON writes as plain numbers.
  if (word == "int") return Type::int64(quantity);
  if (word == "double") return Type::float64(quantity);
  if (word == "string") return Type::string();
  if (word == "time") return Type::time();
  if (word == "link") return Type::memory_link();
  if (word == "position") return Type::ndarray(ElementType::kFloat64, {3}, quantity);
  if (word == "pose") return Type::pose(ElementType::kFloat64);
  if (word == "numbers") return Type::ndarray(ElementType::kFloat64, {idf::kFreeSize}, quantity);
  return value.error(
      fmt::format("found '{}', needs one of bool, int, double, string, time, link, "
                  "position, pose, numbers",
                  word));
}

/// A list of numbers as an array, where an array is needed: JSON and YAML have no arrays.
Data with_arrays(const Data& given, const Type& type) {
  if (type.kind() == idf::TypeKind::kPose) {
    const auto* dict = given.get_if<idf::Dict>();
    if (dict == nullptr) return given;
    idf::Dict pose;
    for (const auto& [key, value] : *dict)
      pose.set(key, with_arrays(value, Type::ndarray_of_rank(ElementType::kFloat64, 1)));
    return pose;
  }
  const auto* list = given.get_if<idf::List>();
  if (list == nullptr || !type.as_array()) return given;
  std::vector<double> numbers;
  for (const Data& element : *list) {
    const auto number = element.as_number();
    if (!number || element.is<bool>()) return given;
    numbers.push_back(*number);
  }
  const auto count = static_cast<int64_t>(numbers.size());
  return idf::NdArray::take({count}, std::move(numbers));
}

/// An integer where a float is needed: JSON writes 1 for 1.0.
Data with_float(const Data& given, const Type& type) {
  if (type.kind() == idf::TypeKind::kDouble && !given.is<bool>())
    if (const auto number = given.as_number()) return *number;
  return given;
}

Result<Data> config_data(const ConfigValue& value) {
  if (value.is_list()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto elements, value.list());
    idf::List list;
    for (const ConfigValue& element : elements) {
      ENGRAM_ASSIGN_OR_RETURN(Data data, config_data(element));
      list.push_back(std::move(data));
    }
    return Data(std::move(list));
  }
  if (value.is_map()) {
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
    idf::Dict dict;
    for (const std::string& key : map.keys()) {
      ENGRAM_ASSIGN_OR_RETURN(Data data, config_data(*map.find(key)));
      dict.set(key, std::move(data));
    }
    return Data(std::move(dict));
  }
  if (!value.is_quoted()) {
    if (const auto flag = value.boolean(); flag.ok()) return Data(*flag);
    if (const auto integer = value.integer(); integer.ok()) return Data(*integer);
    if (const auto number = value.number(); number.ok()) return Data(*number);
  }
  ENGRAM_ASSIGN_OR_RETURN(std::string text, value.text());
  return Data(std::move(text));
}

/// The value of one parameter, or what does not fit of it.
Result<Data> fit_one(const SkillParameter& parameter, const Data& given) {
  const Data prepared = with_float(with_arrays(given, parameter.type), parameter.type);
  idf::CastResult cast = idf::cast(prepared, parameter.type);
  std::vector<std::string> problems;
  for (const idf::CastNote& note : cast.notes) {
    // A float32 of 0.1 is what the parameter's type says.
    if (note.kind == idf::CastNote::Kind::kNarrowed) continue;
    const std::string path =
        note.what.path.empty() ? parameter.name : parameter.name + "/" + note.what.path;
    problems.push_back(
        fmt::format("'{}': found {}, needs {}", path, note.what.found, note.what.needed));
  }
  if (problems.empty() && parameter.type.kind() == idf::TypeKind::kMemoryLink) {
    const auto id = ltm::MemoryId::parse(cast.value.get<std::string>());
    if (!id.ok())
      problems.push_back(fmt::format("'{}': {}", parameter.name, id.status().message()));
  }
  if (problems.empty() && !parameter.choices.empty() &&
      std::ranges::find(parameter.choices, cast.value.get<std::string>()) ==
          parameter.choices.end())
    problems.push_back(fmt::format("'{}': found '{}', needs one of {}", parameter.name,
                                   cast.value.get<std::string>(),
                                   fmt::join(parameter.choices, ", ")));
  if (!problems.empty()) return invalid_argument("{}", fmt::join(problems, "; "));
  return std::move(cast.value);
}

Result<SkillParameter> read_parameter(const std::string& name, const ConfigValue& value) {
  SkillParameter parameter{.name = name};
  // `speed: double` is short for `speed: {type: double}`.
  if (value.is_text()) {
    ENGRAM_ASSIGN_OR_RETURN(parameter.type, parameter_type(value, {}));
    ENGRAM_ASSIGN_OR_RETURN(parameter.type_name, value.text());
    return parameter;
  }
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  idf::Quantity quantity;
  ENGRAM_RETURN_IF_ERROR(map.read("unit", quantity.unit, &ConfigValue::text));
  for (const auto& [key, bound] : {std::pair{"min", &quantity.minimum}, {"max", &quantity.maximum}})
    ENGRAM_RETURN_IF_ERROR(map.read(key, *bound, &ConfigValue::number));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue type, map.require("type"));
  ENGRAM_ASSIGN_OR_RETURN(parameter.type_name, type.text());
  ENGRAM_ASSIGN_OR_RETURN(parameter.type, parameter_type(type, quantity));
  if (parameter.type.quantity() == nullptr && (quantity.is_bounded() || !quantity.unit.empty()))
    return value.error(fmt::format("a {} has neither unit nor bounds", parameter.type_name));
  if (quantity.minimum && quantity.maximum && *quantity.minimum > *quantity.maximum)
    return value.error(
        fmt::format("found min {} above max {}", *quantity.minimum, *quantity.maximum));
  ENGRAM_RETURN_IF_ERROR(map.read("doc", parameter.doc, &ConfigValue::text));
  if (const auto choices = map.find("choices")) {
    if (parameter.type.kind() != idf::TypeKind::kString)
      return choices->error(
          fmt::format("a {} has no choices, needs a string", parameter.type_name));
    ENGRAM_ASSIGN_OR_RETURN(const auto words, choices->list());
    for (const ConfigValue& word : words) {
      ENGRAM_ASSIGN_OR_RETURN(std::string text, word.text());
      parameter.choices.push_back(std::move(text));
    }
  }
  if (const auto value_if_missing = map.find("default")) {
    ENGRAM_ASSIGN_OR_RETURN(const Data data, config_data(*value_if_missing));
    auto fitting = fit_one(parameter, data);
    if (!fitting.ok()) return value_if_missing->error(fitting.status());
    parameter.default_value = *std::move(fitting);
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return parameter;
}

}  // namespace

Result<ParameterSet> ParameterSet::read(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  ParameterSet set;
  const std::vector<std::string> names = map.keys();
  if (names.size() > kMaxParameters)
    return value.error(
        fmt::format("found {} parameters, needs at most {}", names.size(), kMaxParameters));
  for (const std::string& name : names) {
    const auto described = map.find(name);
    if (!described) return value.error(fmt::format("parameter '{}': needs a type", name));
    ENGRAM_ASSIGN_OR_RETURN(SkillParameter parameter, read_parameter(name, *described));
    set.all_.push_back(std::move(parameter));
  }
  return set;
}

const SkillParameter* ParameterSet::find(std::string_view name) const {
  const auto found = std::ranges::find(all_, name, &SkillParameter::name);
  return found == all_.end() ? nullptr : &*found;
}

Result<Data> ParameterSet::fit(const Data& given) const {
  const auto* dict = given.get_if<idf::Dict>();
  if (dict == nullptr)
    return invalid_argument("parameters: found {}, needs a dict", given.kind_name());
  std::vector<std::string> problems;
  std::vector<std::string> names;
  for (const SkillParameter& parameter : all_) names.push_back(parameter.name);
  for (const auto& [key, value] : *dict) {
    if (find(key) != nullptr) continue;
    const auto close = closest_word(key, names);
    problems.push_back(fmt::format("'{}': there is no such parameter{}", key,
                                   close ? fmt::format(", did you mean '{}'?", *close) : ""));
  }
  idf::Dict fitting;
  for (const SkillParameter& parameter : all_) {
    const Data* value = dict->find(parameter.name);
    if (value == nullptr && parameter.default_value) value = &*parameter.default_value;
    if (value == nullptr) {
      problems.push_back(
          fmt::format("'{}': is missing, needs a {}", parameter.name, parameter.type_name));
      continue;
    }
    auto one = fit_one(parameter, *value);
    if (one.ok())
      fitting.append_unique(parameter.name, *std::move(one));
    else
      problems.push_back(one.status().message());
  }
  if (!problems.empty()) return invalid_argument("parameters: {}", fmt::join(problems, "; "));
  return Data(std::move(fitting));
}

std::vector<ltm::MemoryId> links_of(const ParameterSet& set, const Data& values) {
  std::vector<ltm::MemoryId> links;
  for (const SkillParameter& parameter : set.all()) {
    if (parameter.type.kind() != idf::TypeKind::kMemoryLink) continue;
    const Data* value = values.at(idf::join_path("", parameter.name));
    const auto* text = value == nullptr ? nullptr : value->get_if<std::string>();
    if (text == nullptr || text->empty()) continue;
    if (auto id = ltm::MemoryId::parse(*text); id.ok()) links.push_back(*std::move(id));
  }
  return links;
}

}  // namespace engram::skills
