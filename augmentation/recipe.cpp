// SPDX-License-Identifier: Apache-2.0
#include "augmentation/recipe.h"

#include "ltm/idf/json.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kVersion = 1;
constexpr size_t kMaxChanges = 64;

Result<Change> change_from(const idf::Data& data, size_t number) {
  const auto* dict = data.get_if<idf::Dict>();
  const idf::Data* name = dict == nullptr ? nullptr : dict->find("change");
  if (name == nullptr || !name->is<std::string>())
    return invalid_argument("recipe: change {}: needs a dict with the name of a 'change'", number);
  Change change{name->get<std::string>(), {}};
  for (const auto& [key, value] : *dict)
    if (key != "change") change.parameters.set(key, value);
  return change;
}

}  // namespace

Result<int64_t> Change::integer(std::string_view parameter) const {
  const idf::Data* value = parameters.find(parameter);
  if (value == nullptr)
    return invalid_argument("recipe: change '{}' has no '{}', needs a whole number", name,
                            parameter);
  if (const auto* narrow = value->get_if<int32_t>()) return int64_t{*narrow};
  if (const auto* wide = value->get_if<int64_t>()) return *wide;
  return invalid_argument("recipe: change '{}': '{}' is {}, needs a whole number", name, parameter,
                          value->kind_name());
}

idf::Data Recipe::to_data() const {
  idf::List list;
  for (const Change& change : changes) {
    idf::Dict dict{{"change", change.name}};
    for (const auto& [key, value] : change.parameters) dict.set(key, value);
    list.emplace_back(std::move(dict));
  }
  return idf::Dict{{"version", kVersion}, {"changes", std::move(list)}};
}

Result<Recipe> Recipe::from_data(const idf::Data& data) {
  const idf::Data* version = data.at("version");
  if (version == nullptr || version->as_number() != static_cast<double>(kVersion))
    return invalid_argument("recipe: needs version {}", kVersion);
  const idf::Data* changes = data.at("changes");
  const auto* list = changes == nullptr ? nullptr : changes->get_if<idf::List>();
  if (list == nullptr || list->size() > kMaxChanges)
    return invalid_argument("recipe: needs a list of at most {} 'changes'", kMaxChanges);
  Recipe recipe;
  for (const idf::Data& one : *list) {
    ENGRAM_ASSIGN_OR_RETURN(Change change, change_from(one, recipe.changes.size()));
    recipe.changes.push_back(std::move(change));
  }
  return recipe;
}

Result<std::string> Recipe::to_text() const {
  return idf::to_json_text(to_data());
}

Result<Recipe> Recipe::parse(std::string_view text) {
  const auto data = idf::from_json_text(text);
  if (!data.ok()) return data.status().with_context("recipe");
  return from_data(*data);
}

}  // namespace engram::augmentation
