// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "ltm/typed/convert_value.h"

namespace engram::typed {

template <typename T>
struct Convert<std::optional<T>> {
  static idf::Data write(const std::optional<T>& value, const idf::Type& type) {
    return value ? typed::write(*value, type) : idf::Data(idf::None{});
  }

  static bool read(const idf::Data& data, const idf::Type& type, std::optional<T>& value) {
    value.reset();
    return data.is<idf::None>() || typed::read(data, type, value.emplace());
  }

  static bool equal(const std::optional<T>& a, const std::optional<T>& b) {
    return a.has_value() == b.has_value() && (!a || typed::equal(*a, *b));
  }
};

template <typename T>
struct Convert<std::vector<T>> {
  static idf::Data write(const std::vector<T>& value, const idf::Type& type) {
    const idf::Type& element = type.get<idf::types::List>().element;
    idf::List list;
    list.reserve(value.size());
    for (size_t i = 0; i < value.size(); ++i) list.push_back(typed::write<T>(value[i], element));
    return list;
  }

  static bool read(const idf::Data& data, const idf::Type& type, std::vector<T>& value) {
    const auto* list = data.get_if<idf::List>();
    const auto* needed = type.get_if<idf::types::List>();
    if (list == nullptr || needed == nullptr) return false;
    if (needed->size != idf::kFreeSize && list->size() != static_cast<size_t>(needed->size))
      return false;
    value.clear();
    value.reserve(list->size());
    for (const idf::Data& entry : *list) {
      T element{};
      if (!typed::read(entry, needed->element, element)) return false;
      value.push_back(std::move(element));
    }
    return true;
  }

  static bool equal(const std::vector<T>& a, const std::vector<T>& b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i)
      if (!typed::equal<T>(a[i], b[i])) return false;
    return true;
  }
};

template <typename T, size_t kSize>
struct Convert<std::array<T, kSize>> {
  static idf::Data write(const std::array<T, kSize>& value, const idf::Type& type) {
    const idf::Type& element = type.get<idf::types::List>().element;
    idf::List list;
    list.reserve(kSize);
    for (const T& entry : value) list.push_back(typed::write(entry, element));
    return list;
  }

  static bool read(const idf::Data& data, const idf::Type& type, std::array<T, kSize>& value) {
    const auto* list = data.get_if<idf::List>();
    const auto* needed = type.get_if<idf::types::List>();
    if (list == nullptr || needed == nullptr || list->size() != kSize) return false;
    for (size_t i = 0; i < kSize; ++i)
      if (!typed::read((*list)[i], needed->element, value[i])) return false;
    return true;
  }

  static bool equal(const std::array<T, kSize>& a, const std::array<T, kSize>& b) {
    for (size_t i = 0; i < kSize; ++i)
      if (!typed::equal(a[i], b[i])) return false;
    return true;
  }
};

template <typename T>
struct Convert<std::map<std::string, T, std::less<>>> {
  using Map = std::map<std::string, T, std::less<>>;

  static idf::Data write(const Map& value, const idf::Type& type) {
    const idf::Type& element = type.get<idf::types::Dict>().element;
    idf::Dict dict;
    dict.reserve(value.size());
    for (const auto& [key, entry] : value) dict.append_unique(key, typed::write(entry, element));
    return dict;
  }

  static bool read(const idf::Data& data, const idf::Type& type, Map& value) {
    const auto* dict = data.get_if<idf::Dict>();
    const auto* needed = type.get_if<idf::types::Dict>();
    if (dict == nullptr || needed == nullptr) return false;
    value.clear();
    for (const idf::DictEntry& entry : *dict) {
      const auto place = value.try_emplace(value.end(), entry.key);
      if (!typed::read(entry.value, needed->element, place->second)) return false;
    }
    return true;
  }

  static bool equal(const Map& a, const Map& b) {
    if (a.size() != b.size()) return false;
    for (auto in_a = a.begin(), in_b = b.begin(); in_a != a.end(); ++in_a, ++in_b)
      if (in_a->first != in_b->first || !typed::equal(in_a->second, in_b->second)) return false;
    return true;
  }
};

template <typename... Ts>
struct Convert<std::tuple<Ts...>> {
  using Tuple = std::tuple<Ts...>;

  static idf::Data write(const Tuple& value, const idf::Type& type) {
    const auto& elements = type.get<idf::types::Tuple>().elements;
    idf::List list;
    list.reserve(sizeof...(Ts));
    for_each_index([&]<size_t i>() {
      list.push_back(typed::write(std::get<i>(value), elements[i]));
      return true;
    });
    return list;
  }

  static bool read(const idf::Data& data, const idf::Type& type, Tuple& value) {
    const auto* list = data.get_if<idf::List>();
    const auto* needed = type.get_if<idf::types::Tuple>();
    if (list == nullptr || needed == nullptr || list->size() != sizeof...(Ts)) return false;
    return for_each_index([&]<size_t i>() {
      return typed::read((*list)[i], needed->elements[i], std::get<i>(value));
    });
  }

  static bool equal(const Tuple& a, const Tuple& b) {
    return for_each_index([&]<size_t i>() { return typed::equal(std::get<i>(a), std::get<i>(b)); });
  }

 private:
  /// Calls `visit` for each index until one call returns false.
  template <typename Visit>
  static bool for_each_index(Visit visit) {
    return [&]<size_t... i>(std::index_sequence<i...>) {
      return (visit.template operator()<i>() && ...);
    }
    (std::index_sequence_for<Ts...>());
  }
};

template <typename A, typename B>
struct Convert<std::pair<A, B>> {
  static idf::Data write(const std::pair<A, B>& value, const idf::Type& type) {
    const auto& pair = type.get<idf::types::Pair>();
    idf::List list;
    list.reserve(2);
    list.push_back(typed::write(value.first, pair.first));
    list.push_back(typed::write(value.second, pair.second));
    return list;
  }

  static bool read(const idf::Data& data, const idf::Type& type, std::pair<A, B>& value) {
    const auto* list = data.get_if<idf::List>();
    const auto* needed = type.get_if<idf::types::Pair>();
    return list != nullptr && needed != nullptr && list->size() == 2 &&
           typed::read((*list)[0], needed->first, value.first) &&
           typed::read((*list)[1], needed->second, value.second);
  }

  static bool equal(const std::pair<A, B>& a, const std::pair<A, B>& b) {
    return typed::equal(a.first, b.first) && typed::equal(a.second, b.second);
  }
};

}  // namespace engram::typed
