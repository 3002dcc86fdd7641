// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::idf {

class Data;
struct DictEntry;

/// The value of an optional member that is absent.
struct None {
  friend bool operator==(None, None) { return true; }
};

using List = std::vector<Data>;

/// A map with unique keys that keeps the order of insertion. Look-up is linear, because keys are
/// the few members of an object.
class Dict {
 public:
  // Defined after DictEntry is complete: a value holds dicts, and a dict holds values.
  Dict();
  Dict(std::initializer_list<DictEntry> entries);
  Dict(const Dict& other);
  Dict(Dict&& other) noexcept;
  Dict& operator=(const Dict& other);
  Dict& operator=(Dict&& other) noexcept;
  ~Dict();

  /// Replaces the value of an existing key, otherwise appends.
  void set(std::string_view key, Data value);

  /// Appends without searching for the key, and returns the value, valid until the dict changes.
  /// The caller must know that `key` is new.
  Data& append_unique(std::string key, Data value);

  /// Null where there is no such key; valid until the dict changes.
  [[nodiscard]] const Data* find(std::string_view key) const;
  [[nodiscard]] Data* find(std::string_view key);

  [[nodiscard]] size_t size() const;
  [[nodiscard]] bool empty() const;
  void reserve(size_t count);

  [[nodiscard]] std::vector<DictEntry>::const_iterator begin() const;
  [[nodiscard]] std::vector<DictEntry>::const_iterator end() const;

  /// The order counts: two dicts are equal if they print alike.
  friend bool operator==(const Dict& a, const Dict& b);

 private:
  std::vector<DictEntry> entries_;
};

/// A value of the Interpretable Data Format (IDF); everything in a memory is such a value.
///
/// Visit it with `std::visit` on `value()`, or access a part with `at("pose/position")`. Copies
/// share ndarray buffers. Equality is bit-wise for numbers: NaN equals the same NaN.
/// Source: docs/design.md, section 2.
class Data {
 public:
  using Value =
      std::variant<None, bool, int32_t, int64_t, float, double, std::string, NdArray, List, Dict>;

  Data() = default;
  Data(None) {}
  // Exact types only: a silent conversion (pointer to bool, size_t to double) would change the
  // value.
  template <typename T>
    requires(std::same_as<T, bool> || std::same_as<T, int32_t> || std::same_as<T, int64_t> ||
             std::same_as<T, float> || std::same_as<T, double>)
  Data(T value) : value_(value) {}
  Data(std::string value) : value_(std::move(value)) {}
  Data(std::string_view value) : value_(std::string(value)) {}
  Data(const char* value) : value_(std::string(value)) {}
  Data(NdArray value) : value_(std::move(value)) {}
  Data(List value) : value_(std::move(value)) {}
  Data(Dict value) : value_(std::move(value)) {}

  [[nodiscard]] const Value& value() const { return value_; }
  [[nodiscard]] Value& value() { return value_; }

  template <typename T>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<T>(value_);
  }
  /// Null if this is not a T.
  template <typename T>
  [[nodiscard]] const T* get_if() const {
    return std::get_if<T>(&value_);
  }
  template <typename T>
  [[nodiscard]] T* get_if() {
    return std::get_if<T>(&value_);
  }
  /// Aborts if this is not a T; for values that were checked before.
  template <typename T>
  [[nodiscard]] const T& get() const {
    const T* value = get_if<T>();
    ENGRAM_CHECK(value != nullptr, "value is {}", kind_name());
    return *value;
  }

  /// "none", "bool", "int32", "string", "ndarray", "list", "dict", ...
  [[nodiscard]] std::string_view kind_name() const;

  /// The value at a path of dict keys and list indices; null where there is none.
  /// A `/` inside a key is written `\/`. The empty path is this value itself.
  [[nodiscard]] const Data* at(std::string_view path) const;
  [[nodiscard]] Data* at(std::string_view path);

  /// A bool, int or float as a double; nothing for other kinds.
  [[nodiscard]] std::optional<double> as_number() const;

  friend bool operator==(const Data& a, const Data& b);

 private:
  Value value_;
};

struct DictEntry {
  std::string key;
  Data value;

  friend bool operator==(const DictEntry& a, const DictEntry& b);
};

inline Dict::Dict() = default;
inline Dict::Dict(const Dict& other) = default;
inline Dict::Dict(Dict&& other) noexcept = default;
inline Dict& Dict::operator=(const Dict& other) = default;
inline Dict& Dict::operator=(Dict&& other) noexcept = default;
inline Dict::~Dict() = default;

inline size_t Dict::size() const { return entries_.size(); }
inline bool Dict::empty() const { return entries_.empty(); }
inline std::vector<DictEntry>::const_iterator Dict::begin() const { return entries_.begin(); }
inline std::vector<DictEntry>::const_iterator Dict::end() const { return entries_.end(); }

/// Splits "a\/b/c" into {"a/b", "c"}; `\\` is a backslash, `\e` an empty name.
[[nodiscard]] std::vector<std::string> split_path(std::string_view path);

/// Appends `name` to `path`, escaped so that split_path returns it.
[[nodiscard]] std::string join_path(std::string_view path, std::string_view name);

}  // namespace engram::idf
