// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "ltm/idf/data.h"

// The three objects of the paper's timings (Peller-Konrad et al., section "Performance"), as plain
// structs with their conversions, written as a program would.
namespace engram::benchmark_objects {

struct Simple {
  int64_t value = 42;

  [[nodiscard]] idf::Data to_idf() const { return idf::Dict{{"value", value}}; }
  static Simple from_idf(const idf::Data& data) { return {data.at("value")->get<int64_t>()}; }
};

struct Moderate {
  int64_t value = 42;
  std::string text = "hello";
  std::string link = "Vision/RGB/head/cam";

  [[nodiscard]] idf::Data to_idf() const {
    idf::Dict dict;
    dict.reserve(3);
    dict.append_unique("value", value);
    dict.append_unique("text", text);
    dict.append_unique("link", link);
    return dict;
  }
  static Moderate from_idf(const idf::Data& data) {
    const auto& dict = data.get<idf::Dict>();
    return {dict.find("value")->get<int64_t>(), dict.find("text")->get<std::string>(),
            dict.find("link")->get<std::string>()};
  }
};

/// Links, nested objects, an image of 128 x 128 x 3 and several maps. The image is a view: it is
/// copied in neither direction.
struct Complex {
  Moderate head;
  Simple nested;
  idf::NdArray image = idf::NdArray::take<uint8_t>({128, 128, 3}, std::vector<uint8_t>(49152, 127));
  std::vector<std::pair<std::string, float>> confidences{{"cup", 0.9f}, {"box", 0.1f}};
  std::vector<std::pair<std::string, int32_t>> counts{{"cup", 1}, {"box", 2}};

  [[nodiscard]] idf::Data to_idf() const {
    idf::Dict dict;
    dict.reserve(5);
    dict.append_unique("head", head.to_idf());
    dict.append_unique("nested", nested.to_idf());
    dict.append_unique("image", image);
    dict.append_unique("confidences", map_to_idf(confidences));
    dict.append_unique("counts", map_to_idf(counts));
    return dict;
  }
  static Complex from_idf(const idf::Data& data) {
    const auto& dict = data.get<idf::Dict>();
    return {Moderate::from_idf(*dict.find("head")), Simple::from_idf(*dict.find("nested")),
            dict.find("image")->get<idf::NdArray>(), map_from_idf<float>(*dict.find("confidences")),
            map_from_idf<int32_t>(*dict.find("counts"))};
  }

 private:
  template <typename T>
  static idf::Data map_to_idf(const std::vector<std::pair<std::string, T>>& map) {
    idf::Dict dict;
    dict.reserve(map.size());
    for (const auto& [key, value] : map) dict.append_unique(key, value);
    return dict;
  }
  template <typename T>
  static std::vector<std::pair<std::string, T>> map_from_idf(const idf::Data& data) {
    std::vector<std::pair<std::string, T>> map;
    for (const auto& [key, value] : data.get<idf::Dict>()) map.emplace_back(key, value.template get<T>());
    return map;
  }
};

}  // namespace engram::benchmark_objects
