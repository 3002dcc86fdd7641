// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/idf/type.h"
#include "ltm/memory/memory_id.h"

namespace engram::typed {

/// Converts a C++ type to and from a value of the Interpretable Data Format. Each type has a
/// specialisation with
///
///     static idf::Data write(const T& value, const idf::Type& type);
///     static bool read(const idf::Data& data, const idf::Type& type, T& value);
///     static bool equal(const T& a, const T& b);
///
/// `type` is the one that T was generated for; it gives the sizes that T does not fix. Where `read`
/// returns false, `value` is unspecified. Numbers are equal where their bits are equal.
template <typename T>
struct Convert;

template <typename T>
[[nodiscard]] idf::Data write(const T& value, const idf::Type& type) {
  return Convert<T>::write(value, type);
}

template <typename T>
[[nodiscard]] bool read(const idf::Data& data, const idf::Type& type, T& value) {
  return Convert<T>::read(data, type, value);
}

template <typename T>
[[nodiscard]] bool equal(const T& a, const T& b) {
  return Convert<T>::equal(a, b);
}

template <typename T>
concept Number = std::same_as<T, int32_t> || std::same_as<T, int64_t> || std::same_as<T, float> ||
    std::same_as<T, double> || std::same_as<T, bool>;

template <Number T>
struct Convert<T> {
  static idf::Data write(T value, const idf::Type&) { return value; }

  static bool read(const idf::Data& data, const idf::Type&, T& value) {
    const T* found = data.get_if<T>();
    if (found != nullptr) value = *found;
    return found != nullptr;
  }

  static bool equal(T a, T b) {
    if constexpr (std::same_as<T, float>)
      return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b);
    else if constexpr (std::same_as<T, double>)
      return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
    else
      return a == b;
  }
};

template <typename T>
requires std::is_enum_v<T>
struct Convert<T> {
  static idf::Data write(T value, const idf::Type&) { return static_cast<int32_t>(value); }

  static bool read(const idf::Data& data, const idf::Type& type, T& value) {
    const auto* found = data.get_if<int32_t>();
    const auto* names = type.get_if<idf::types::IntEnum>();
    if (found == nullptr || names == nullptr || names->find(*found) == nullptr) return false;
    value = static_cast<T>(*found);
    return true;
  }

  static bool equal(T a, T b) { return a == b; }
};

template <>
struct Convert<std::string> {
  static idf::Data write(const std::string& value, const idf::Type&) { return value; }

  static bool read(const idf::Data& data, const idf::Type&, std::string& value) {
    const auto* found = data.get_if<std::string>();
    if (found != nullptr) value = *found;
    return found != nullptr;
  }

  static bool equal(const std::string& a, const std::string& b) { return a == b; }
};

template <>
struct Convert<Time> {
  static idf::Data write(Time value, const idf::Type&) { return to_ns(value); }

  static bool read(const idf::Data& data, const idf::Type&, Time& value) {
    const auto* found = data.get_if<int64_t>();
    if (found != nullptr) value = time_from_ns(*found);
    return found != nullptr;
  }

  static bool equal(Time a, Time b) { return a == b; }
};

template <>
struct Convert<ltm::MemoryId> {
  static idf::Data write(const ltm::MemoryId& value, const idf::Type&) { return value.to_data(); }

  static bool read(const idf::Data& data, const idf::Type&, ltm::MemoryId& value) {
    const auto* text = data.get_if<std::string>();
    if (text == nullptr) return false;
    auto parsed = ltm::MemoryId::parse(*text);
    if (parsed.ok()) value = std::move(*parsed);
    return parsed.ok();
  }

  static bool equal(const ltm::MemoryId& a, const ltm::MemoryId& b) { return a == b; }
};

template <>
struct Convert<idf::NdArray> {
  static idf::Data write(const idf::NdArray& value, const idf::Type&) { return value; }

  static bool read(const idf::Data& data, const idf::Type& type, idf::NdArray& value) {
    const auto* found = data.get_if<idf::NdArray>();
    const auto* needed = type.get_if<idf::types::NdArray>();
    if (found == nullptr || needed == nullptr || found->type() != needed->element) return false;
    const idf::Shape& shape = found->shape();
    if (shape.size() != needed->shape.size()) return false;
    for (size_t i = 0; i < shape.size(); ++i)
      if (needed->shape[i] != idf::kFreeSize && needed->shape[i] != shape[i]) return false;
    value = *found;
    return true;
  }

  static bool equal(const idf::NdArray& a, const idf::NdArray& b) { return a == b; }
};

}  // namespace engram::typed
