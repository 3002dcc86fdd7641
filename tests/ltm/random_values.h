// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/idf/data.h"

namespace engram {

/// Made-up IDF values of every kind, odd keys, empty containers and NaNs included. The same seed
/// gives the same values.
class RandomValues {
 public:
  explicit RandomValues(uint64_t seed) : generator_(seed) {}

  size_t below(size_t end) { return static_cast<size_t>(generator_() % end); }
  uint64_t bits() { return generator_(); }

  std::string text() {
    static constexpr std::array<std::string_view, 12> kParts{"a",  "Z",  "7", "/", "\\", "ü",
                                                             "机", "\"", "$", ".", " ",  "\n"};
    std::string made;
    for (size_t count = below(9); count > 0; --count) made += kParts[below(kParts.size())];
    return made;
  }

  std::string key() {
    static constexpr std::array<std::string_view, 10> kOdd{"",    "$", "$int32", "a/b", "\\",
                                                           "\\e", ".", "%",      "#1",  "größe"};
    return below(4) == 0 ? std::string(kOdd[below(kOdd.size())]) : "k" + text();
  }

  idf::NdArray array() {
    idf::Shape shape;
    for (size_t rank = below(4); rank > 0; --rank) shape.push_back(static_cast<int64_t>(below(5)));
    switch (below(5)) {
      case 0:
        return filled<uint8_t>(shape);
      case 1:
        return filled<int16_t>(shape);
      case 2:
        return filled<uint64_t>(shape);
      case 3:
        return filled<float>(shape);
      default:
        return filled<double>(shape);
    }
  }

  idf::Data value(int depth) {
    switch (below(depth > 0 ? 10 : 8)) {
      case 0:
        return idf::None{};
      case 1:
        return below(2) == 0;
      case 2:
        return static_cast<int32_t>(bits());
      case 3:
        return static_cast<int64_t>(bits());
      case 4:
        return std::bit_cast<float>(static_cast<uint32_t>(bits()));
      case 5:
        return std::bit_cast<double>(bits());
      case 6:
        return text();
      case 7:
        return array();
      case 8:
        return list(depth - 1);
      default:
        return dict(depth - 1);
    }
  }

  idf::List list(int depth) {
    idf::List made;
    for (size_t count = below(5); count > 0; --count) made.push_back(value(depth));
    return made;
  }

  idf::Dict dict(int depth) {
    idf::Dict made;
    for (size_t count = below(6); count > 0; --count) made.set(key(), value(depth));
    return made;
  }

 private:
  template <typename T>
  idf::NdArray filled(const idf::Shape& shape) {
    size_t count = 1;
    for (const int64_t size : shape) count *= static_cast<size_t>(size);
    std::vector<T> values(count);
    for (T& element : values) {
      const uint64_t random = bits();
      std::memcpy(&element, &random, sizeof(T));
    }
    return idf::NdArray::take(shape, std::move(values));
  }

  std::mt19937_64 generator_;
};

/// Lists inside each other: `depth` of them, around a number.
inline idf::Data nested_lists(int depth) {
  idf::Data value = 7;
  for (int i = 0; i < depth; ++i) {
    idf::List outer;
    outer.push_back(std::move(value));
    value = std::move(outer);
  }
  return value;
}

inline idf::Data nested_dicts(int depth) {
  idf::Data value = 7;
  for (int i = 0; i < depth; ++i) {
    idf::Dict outer;
    outer.set("inner", std::move(value));
    value = std::move(outer);
  }
  return value;
}

}  // namespace engram
