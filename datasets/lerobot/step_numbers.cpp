// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/step_numbers.h"

#include <limits>

namespace engram::datasets::lerobot {

namespace {

template <typename Number>
Result<std::optional<Number>> number_of(const RowTable& table, size_t column) {
  if constexpr (std::is_floating_point_v<Number>) {
    ENGRAM_ASSIGN_OR_RETURN(const auto number, table.number(column));
    if (!number) return std::optional<Number>();
    return std::optional(static_cast<Number>(*number));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(const auto number, table.integer(column));
    if (!number) return std::optional<Number>();
    if (*number < static_cast<int64_t>(std::numeric_limits<Number>::min()) ||
        *number > static_cast<int64_t>(std::numeric_limits<Number>::max()))
      return table.broken(column, fmt::format("needs a number of {} bits", 8 * sizeof(Number)));
    return std::optional(static_cast<Number>(*number));
  }
}

template <typename Number>
Result<std::optional<idf::NdArray>> array_of(const RowTable& table, const Feature& feature,
                                             const std::vector<size_t>& columns) {
  std::vector<Number> numbers;
  numbers.reserve(columns.size());
  for (const size_t column : columns) {
    ENGRAM_ASSIGN_OR_RETURN(const auto number, number_of<Number>(table, column));
    if (!number) return std::optional<idf::NdArray>();
    numbers.push_back(*number);
  }
  return std::optional(idf::NdArray::take(feature.shape, std::move(numbers)));
}

Result<std::optional<idf::NdArray>> typed_array(const RowTable& table, const Feature& feature,
                                                const std::vector<size_t>& columns) {
  const std::string& type = feature.dtype;
  if (type == "float32" || type == "float16") return array_of<float>(table, feature, columns);
  if (type == "int64") return array_of<int64_t>(table, feature, columns);
  if (type == "int32") return array_of<int32_t>(table, feature, columns);
  if (type == "int16") return array_of<int16_t>(table, feature, columns);
  if (type == "int8") return array_of<int8_t>(table, feature, columns);
  if (type == "uint32") return array_of<uint32_t>(table, feature, columns);
  if (type == "uint16") return array_of<uint16_t>(table, feature, columns);
  if (type == "uint8" || type == "bool") return array_of<uint8_t>(table, feature, columns);
  return array_of<double>(table, feature, columns);
}

}  // namespace

std::string last_part(const std::string& key) {
  return key.substr(key.rfind('.') == std::string::npos ? 0 : key.rfind('.') + 1);
}

std::vector<size_t> columns_of(const RowTable& table, const Feature& feature) {
  std::vector<size_t> columns;
  for (size_t i = 0; i < feature.count; ++i) {
    std::vector<std::string> names;
    for (const std::string& key : {feature.key, last_part(feature.key)}) {
      if (!feature.names.empty()) names.push_back(key + "." + feature.names[i]);
      names.push_back(key + "." + std::to_string(i));
      if (feature.count == 1) names.push_back(key);
    }
    const auto column = table.find(names);
    if (!column) return {};
    columns.push_back(*column);
  }
  return columns;
}

Result<std::optional<idf::Dict>> numbers_of(const RowTable& table, const Feature& feature,
                                            const std::vector<size_t>& columns) {
  if (feature.kind == Feature::Kind::kText)
    return std::optional(idf::Dict{{"text", table.text(columns.front())}});
  if (feature.names.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(auto array, typed_array(table, feature, columns));
    if (!array) return std::optional<idf::Dict>();
    return std::optional(idf::Dict{{"values", *std::move(array)}});
  }
  idf::Dict value;
  value.reserve(columns.size());
  for (size_t i = 0; i < columns.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto number, table.number(columns[i]));
    if (!number) return std::optional<idf::Dict>();
    value.append_unique(feature.names[i], *number);
  }
  return std::optional(std::move(value));
}

}  // namespace engram::datasets::lerobot
