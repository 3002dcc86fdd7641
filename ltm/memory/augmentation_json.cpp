// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/augmentation_json.h"

#include <nlohmann/json.hpp>

#include "ltm/core/utf8.h"

namespace engram::ltm {

namespace {

using Json = nlohmann::ordered_json;

Json recipe_json(const std::string& recipe) {
  const Json json = Json::parse(recipe, nullptr, false);
  if (!json.is_discarded()) return json;
  return is_utf8(recipe) ? Json(recipe) : Json("not readable: no UTF-8");
}

}  // namespace

Json augmentation_json(const InstanceMetadata& metadata) {
  Json json = Json::object();
  if (metadata.origin.depth() > 0) json["origin"] = metadata.origin.to_string();
  if (!metadata.recipe.empty()) json["recipe"] = recipe_json(metadata.recipe);
  return json;
}

Status read_augmentation(const Json& json, InstanceMetadata& metadata) {
  if (const auto origin = json.find("origin"); origin != json.end()) {
    if (!origin->is_string())
      return invalid_argument("origin: found {}, needs a memory ID", origin->dump());
    ENGRAM_ASSIGN_OR_RETURN(metadata.origin, MemoryId::parse(origin->get<std::string>()));
  }
  if (const auto recipe = json.find("recipe"); recipe != json.end())
    metadata.recipe = recipe->is_string() ? recipe->get<std::string>() : recipe->dump();
  return {};
}

}  // namespace engram::ltm
