// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/json_values.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace engram::datasets::mcap {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxDepth = 64;

Result<idf::Data> value_of(const Json& json, int depth) {
  if (depth > kMaxDepth) return data_loss("JSON nests deeper than {}", kMaxDepth);
  switch (json.type()) {
    case Json::value_t::boolean:
      return idf::Data(json.get<bool>());
    case Json::value_t::number_integer:
      return idf::Data(json.get<int64_t>());
    case Json::value_t::number_unsigned: {
      const auto number = json.get<uint64_t>();
      if (number > static_cast<uint64_t>(std::numeric_limits<int64_t>::max()))
        return idf::Data(idf::NdArray::take<uint64_t>({}, {number}));
      return idf::Data(static_cast<int64_t>(number));
    }
    case Json::value_t::number_float:
      return idf::Data(json.get<double>());
    case Json::value_t::string:
      return idf::Data(json.get<std::string>());
    case Json::value_t::array: {
      idf::List list;
      for (const Json& element : json) {
        ENGRAM_ASSIGN_OR_RETURN(idf::Data value, value_of(element, depth + 1));
        list.push_back(std::move(value));
      }
      return idf::Data(std::move(list));
    }
    case Json::value_t::object: {
      idf::Dict dict;
      for (const auto& [key, member] : json.items()) {
        ENGRAM_ASSIGN_OR_RETURN(idf::Data value, value_of(member, depth + 1));
        dict.append_unique(key, std::move(value));
      }
      return idf::Data(std::move(dict));
    }
    default:
      return idf::Data();
  }
}

Result<Json> json_of(const idf::Data& value) {
  if (value.is<idf::None>()) return Json(nullptr);
  if (const auto* found = value.get_if<bool>()) return Json(*found);
  if (const auto* found = value.get_if<int32_t>()) return Json(*found);
  if (const auto* found = value.get_if<int64_t>()) return Json(*found);
  if (const auto* found = value.get_if<double>(); found != nullptr && std::isfinite(*found))
    return Json(*found);
  if (const auto* found = value.get_if<std::string>()) return Json(*found);
  if (const auto* found = value.get_if<idf::NdArray>();
      found != nullptr && found->rank() == 0 && found->type() == idf::ElementType::kUInt64)
    return Json(found->values<uint64_t>().front());
  if (const auto* found = value.get_if<idf::List>()) {
    Json list = Json::array();
    for (const idf::Data& element : *found) {
      ENGRAM_ASSIGN_OR_RETURN(Json json, json_of(element));
      list.push_back(std::move(json));
    }
    return list;
  }
  if (const auto* found = value.get_if<idf::Dict>()) {
    Json dict = Json::object();
    for (const auto& [key, member] : *found) {
      ENGRAM_ASSIGN_OR_RETURN(Json json, json_of(member));
      dict[key] = std::move(json);
    }
    return dict;
  }
  return invalid_argument("plain JSON holds no {} like this", value.kind_name());
}

}  // namespace

Result<idf::Data> value_of_json(std::string_view text) {
  // The depth is checked before anything is built, because destroying deep values recurses too.
  int depth = 0;
  bool is_text = false;
  for (size_t i = 0; i < text.size(); ++i) {
    if (is_text && text[i] == '\\')
      ++i;
    else if (text[i] == '"')
      is_text = !is_text;
    else if (!is_text && (text[i] == '[' || text[i] == '{'))
      ++depth;
    else if (!is_text && (text[i] == ']' || text[i] == '}'))
      --depth;
    if (depth > kMaxDepth) return data_loss("byte {}: JSON nests deeper than {}", i, kMaxDepth);
  }
  try {
    return value_of(Json::parse(text), 0);
  } catch (const Json::exception& error) {
    return data_loss("{}", error.what());
  }
}

Result<std::string> json_of_value(const idf::Data& value) {
  ENGRAM_ASSIGN_OR_RETURN(const Json json, json_of(value));
  // Dumping throws for text that is not UTF-8.
  try {
    return json.dump();
  } catch (const Json::exception& error) {
    return invalid_argument("{}", error.what());
  }
}

}  // namespace engram::datasets::mcap
