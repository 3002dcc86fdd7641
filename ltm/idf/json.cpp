// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/json.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "ltm/idf/base64.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/strict_json.h"

namespace engram::idf {

namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kLargestExactInt = int64_t{1} << 53;
constexpr int64_t kBase64FromCount = 64;

/// "nan", "inf", "-inf"; a NaN with other bits than the plain one has them as text: "nan:7fc00001".
template <typename T, typename Bits>
Json unusual_float(T value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const auto bits = std::bit_cast<Bits>(value);
  if (bits == std::bit_cast<Bits>(std::numeric_limits<T>::quiet_NaN())) return "nan";
  return fmt::format("nan:{:x}", bits);
}

template <typename T, typename Bits>
std::optional<T> read_unusual_float(std::string_view text) {
  if (text == "inf") return std::numeric_limits<T>::infinity();
  if (text == "-inf") return -std::numeric_limits<T>::infinity();
  if (text == "nan") return std::numeric_limits<T>::quiet_NaN();
  if (!text.starts_with("nan:")) return std::nullopt;
  text.remove_prefix(4);
  Bits bits = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bits, 16);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  const T value = std::bit_cast<T>(bits);
  return std::isnan(value) ? std::optional(value) : std::nullopt;
}

Json float_to_json(float value) {
  if (!std::isfinite(value)) return unusual_float<float, uint32_t>(value);
  return static_cast<double>(value);
}

Json float_to_json(double value) {
  if (!std::isfinite(value)) return unusual_float<double, uint64_t>(value);
  return value;
}

/// Calls `function` with a value of the C++ type of `type`.
template <typename F>
auto with_element_type(ElementType type, F function) {
  switch (type) {
    case ElementType::kInt8:
      return function(int8_t{});
    case ElementType::kInt16:
      return function(int16_t{});
    case ElementType::kInt32:
      return function(int32_t{});
    case ElementType::kInt64:
      return function(int64_t{});
    case ElementType::kUInt8:
      return function(uint8_t{});
    case ElementType::kUInt16:
      return function(uint16_t{});
    case ElementType::kUInt32:
      return function(uint32_t{});
    case ElementType::kUInt64:
      return function(uint64_t{});
    case ElementType::kFloat32:
      return function(float{});
    case ElementType::kFloat64:
      break;
  }
  return function(double{});
}

Json ndarray_to_json(const NdArray& array) {
  Json json{{"type", to_string(array.type())}, {"shape", array.shape()}};
  if (array.count() >= kBase64FromCount) {
    json["base64"] = to_base64(array.bytes());
  } else {
    json["data"] = with_element_type(array.type(), [&]<typename T>(T) {
      Json elements = Json::array();
      for (const T value : array.values<T>()) {
        if constexpr (std::floating_point<T>)
          elements.push_back(float_to_json(value));
        else
          elements.push_back(value);
      }
      return elements;
    });
  }
  return Json{{"$ndarray", std::move(json)}};
}

Json to_json_checked(const Data& data);

struct JsonWriter {
  Json operator()(None) const { return nullptr; }
  Json operator()(bool value) const { return value; }
  Json operator()(int32_t value) const { return {{"$int32", value}}; }
  Json operator()(int64_t value) const {
    if (std::abs(value / 2) < kLargestExactInt / 2) return value;
    return {{"$int64", std::to_string(value)}};
  }
  Json operator()(float value) const { return {{"$float32", float_to_json(value)}}; }
  Json operator()(double value) const {
    if (std::isfinite(value)) return value;
    return {{"$float64", float_to_json(value)}};
  }
  Json operator()(const std::string& value) const { return value; }
  Json operator()(const NdArray& array) const { return ndarray_to_json(array); }
  Json operator()(const List& list) const {
    Json json = Json::array();
    for (const Data& element : list) json.push_back(to_json_checked(element));
    return json;
  }
  Json operator()(const Dict& dict) const {
    // Built as the underlying vector: the search of operator[] would make large dicts quadratic.
    Json::object_t object;
    for (const auto& [key, value] : dict)
      object.emplace_back(key.starts_with('$') ? "$" + key : key, to_json_checked(value));
    return Json(std::move(object));
  }
};

Json to_json_checked(const Data& data) {
  return std::visit(JsonWriter{}, data.value());
}

bool fits_depth(const Data& data, int levels) {
  if (const List* list = data.get_if<List>()) {
    for (const Data& element : *list)
      if (levels <= 0 || !fits_depth(element, levels - 1)) return false;
  } else if (const Dict* dict = data.get_if<Dict>()) {
    for (const auto& [key, value] : *dict)
      if (levels <= 0 || !fits_depth(value, levels - 1)) return false;
  }
  return true;
}

class JsonReader {
 public:
  explicit JsonReader(int max_depth) : max_depth_(max_depth) {}

  Result<Data> read(const Json& json, const std::string& path, int depth) {
    switch (json.type()) {
      case Json::value_t::null:
        return Data();
      case Json::value_t::boolean:
        return Data(json.get<bool>());
      case Json::value_t::number_float:
        return Data(json.get<double>());
      case Json::value_t::string:
        return Data(json.get<std::string>());
      case Json::value_t::number_integer:
        return Data(json.get<int64_t>());
      case Json::value_t::number_unsigned:
        if (json.get<uint64_t>() > INT64_MAX) return broken(path, "an integer beyond int64");
        return Data(json.get<int64_t>());
      case Json::value_t::array:
        return read_list(json, path, depth);
      case Json::value_t::object:
        return read_object(json, path, depth);
      default:
        return broken(path, "binary JSON");
    }
  }

 private:
  static Status broken(const std::string& path, std::string_view found) {
    return invalid_argument("JSON at '/{}': found {}, which is no IDF value", path, found);
  }

  Result<Data> read_list(const Json& json, const std::string& path, int depth) {
    if (depth >= max_depth_) return broken(path, fmt::format("more than {} levels", max_depth_));
    List list;
    list.reserve(json.size());
    for (size_t i = 0; i < json.size(); ++i) {
      ENGRAM_ASSIGN_OR_RETURN(Data element,
                              read(json[i], join_path(path, std::to_string(i)), depth + 1));
      list.push_back(std::move(element));
    }
    return Data(std::move(list));
  }

  Result<Data> read_object(const Json& json, const std::string& path, int depth) {
    if (json.size() == 1) {
      const std::string& key = json.begin().key();
      if (key.starts_with('$') && !key.starts_with("$$"))
        return read_typed(key, *json.begin(), path);
    }
    if (depth >= max_depth_) return broken(path, fmt::format("more than {} levels", max_depth_));
    Dict dict;
    dict.reserve(json.size());
    for (const auto& [key, value] : json.items()) {
      if (key.starts_with('$') && !key.starts_with("$$"))
        return broken(path, "the type tag '" + key + "' beside other keys");
      std::string name = key.starts_with("$$") ? key.substr(1) : key;
      ENGRAM_ASSIGN_OR_RETURN(Data member, read(value, join_path(path, name), depth + 1));
      dict.append_unique(std::move(name), std::move(member));
    }
    return Data(std::move(dict));
  }

  Result<Data> read_typed(const std::string& tag, const Json& json, const std::string& path) {
    if (tag == "$int32" && json.is_number_integer()) {
      const auto value = integer<int32_t>(json);
      if (value) return Data(*value);
    } else if (tag == "$int64" && json.is_string()) {
      const auto text = json.get<std::string>();
      int64_t value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error == std::errc() && end == text.data() + text.size()) return Data(value);
    } else if (tag == "$float32") {
      if (const auto value = floating<float, uint32_t>(json)) return Data(*value);
    } else if (tag == "$float64") {
      if (const auto value = floating<double, uint64_t>(json)) return Data(*value);
    } else if (tag == "$ndarray" && json.is_object()) {
      return read_ndarray(json, path);
    }
    return broken(path, "a " + tag + " with an unfitting value");
  }

  template <typename T>
  static std::optional<T> integer(const Json& json) {
    if (json.is_number_unsigned()) {
      const auto value = json.get<uint64_t>();
      if (std::in_range<T>(value)) return static_cast<T>(value);
    } else if (json.is_number_integer()) {
      const auto value = json.get<int64_t>();
      if (std::in_range<T>(value)) return static_cast<T>(value);
    }
    return std::nullopt;
  }

  template <typename T, typename Bits>
  static std::optional<T> floating(const Json& json) {
    if (json.is_string()) return read_unusual_float<T, Bits>(json.get<std::string>());
    if (!json.is_number()) return std::nullopt;
    const double value = json.get<double>();
    if (std::abs(value) > static_cast<double>(std::numeric_limits<T>::max())) return std::nullopt;
    return static_cast<T>(value);
  }

  Result<Data> read_ndarray(const Json& json, const std::string& path) {
    const auto type_json = json.find("type");
    const auto shape_json = json.find("shape");
    if (type_json == json.end() || !type_json->is_string() || shape_json == json.end() ||
        !shape_json->is_array())
      return broken(path, "an ndarray without type and shape");
    const auto type = element_type_from_name(type_json->get<std::string>());
    if (!type) return broken(path, "an ndarray of unknown element type");
    Shape shape;
    for (const Json& size : *shape_json) {
      const auto value = integer<int64_t>(size);
      if (!value) return broken(path, "an ndarray whose shape is not of integers");
      shape.push_back(*value);
    }
    ENGRAM_ASSIGN_OR_RETURN(Buffer buffer, read_elements(*type, json, path));
    auto array = NdArray::create(*type, std::move(shape), std::move(buffer));
    if (!array.ok()) return array.status().with_context("JSON at '/" + path + "'");
    return Data(std::move(array).value());
  }

  Result<Buffer> read_elements(ElementType type, const Json& json, const std::string& path) {
    if (const auto base64 = json.find("base64"); base64 != json.end() && base64->is_string()) {
      auto bytes = from_base64(base64->get<std::string>());
      if (bytes) return Buffer::take(std::move(*bytes));
      return broken(path, "an ndarray with broken base64");
    }
    const auto elements = json.find("data");
    if (elements == json.end() || !elements->is_array())
      return broken(path, "an ndarray without data or base64");
    return with_element_type(type, [&]<typename T>(T) -> Result<Buffer> {
      std::vector<T> values;
      values.reserve(elements->size());
      for (const Json& element : *elements) {
        std::optional<T> value;
        if constexpr (std::same_as<T, float>)
          value = floating<float, uint32_t>(element);
        else if constexpr (std::same_as<T, double>)
          value = floating<double, uint64_t>(element);
        else
          value = integer<T>(element);
        if (!value) return broken(path, "an ndarray element that does not fit its type");
        values.push_back(*value);
      }
      return Buffer::take(std::move(values));
    });
  }

  int max_depth_;
};

}  // namespace

Result<Json> to_json(const Data& data, int max_depth) {
  if (!fits_depth(data, max_depth))
    return invalid_argument("IDF value: nests deeper than {} levels", max_depth);
  return to_json_checked(data);
}

Result<std::string> to_json_text(const Data& data, int indent, int max_depth) {
  ENGRAM_ASSIGN_OR_RETURN(const Json json, to_json(data, max_depth));
  try {
    return json.dump(indent);
  } catch (const Json::exception& error) {
    return invalid_argument("IDF value has a string that is not UTF-8: {}", error.what());
  }
}

Result<Data> from_json(const Json& json, int max_depth) {
  return JsonReader(max_depth).read(json, "", 0);
}

Result<Data> from_json_text(std::string_view text, int max_depth) {
  // A typed value nests in levels of its own.
  ENGRAM_ASSIGN_OR_RETURN(const Json json, parse_json(text, 4 * max_depth));
  return from_json(json, max_depth);
}

}  // namespace engram::idf
