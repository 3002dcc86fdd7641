// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

namespace engram::idf {

Dict::Dict(std::initializer_list<DictEntry> entries) {
  entries_.reserve(entries.size());
  for (const DictEntry& entry : entries) set(entry.key, entry.value);
}

void Dict::set(std::string_view key, Data value) {
  if (Data* existing = find(key))
    *existing = std::move(value);
  else
    entries_.push_back({std::string(key), std::move(value)});
}

Data& Dict::append_unique(std::string key, Data value) {
  return entries_.emplace_back(DictEntry{std::move(key), std::move(value)}).value;
}

const Data* Dict::find(std::string_view key) const {
  const auto entry = std::ranges::find(entries_, key, &DictEntry::key);
  return entry == entries_.end() ? nullptr : &entry->value;
}

Data* Dict::find(std::string_view key) {
  return const_cast<Data*>(std::as_const(*this).find(key));
}

void Dict::reserve(size_t count) { entries_.reserve(count); }

bool operator==(const Dict& a, const Dict& b) { return a.entries_ == b.entries_; }

bool operator==(const DictEntry& a, const DictEntry& b) {
  return a.key == b.key && a.value == b.value;
}

std::string_view Data::kind_name() const {
  static constexpr std::array<std::string_view, std::variant_size_v<Value>> kNames{
      "none",   "bool",   "int32",  "int64", "float32",
      "float64", "string", "ndarray", "list",  "dict"};
  return kNames[value_.index()];
}

const Data* Data::at(std::string_view path) const {
  if (path.empty()) return this;
  const Data* current = this;
  for (const std::string& name : split_path(path)) {
    if (const Dict* dict = current->get_if<Dict>()) {
      current = dict->find(name);
    } else if (const List* list = current->get_if<List>()) {
      size_t index = 0;
      const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
      const bool is_index = error == std::errc() && end == name.data() + name.size();
      current = is_index && index < list->size() ? &(*list)[index] : nullptr;
    } else {
      current = nullptr;
    }
    if (current == nullptr) return nullptr;
  }
  return current;
}

Data* Data::at(std::string_view path) { return const_cast<Data*>(std::as_const(*this).at(path)); }

std::optional<double> Data::as_number() const {
  return std::visit(
      [](const auto& value) -> std::optional<double> {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_arithmetic_v<T>)
          return static_cast<double>(value);
        else
          return std::nullopt;
      },
      value_);
}

// Floats are compared by their bits: a copy of NaN equals it, and -0.0 differs from 0.0. Otherwise
// equality could not tell whether a value survived storing.
bool operator==(const Data& a, const Data& b) {
  if (a.value_.index() != b.value_.index()) return false;
  return std::visit(
      [&b](const auto& left) {
        using T = std::decay_t<decltype(left)>;
        const T& right = std::get<T>(b.value_);
        if constexpr (std::same_as<T, float>)
          return std::bit_cast<uint32_t>(left) == std::bit_cast<uint32_t>(right);
        else if constexpr (std::same_as<T, double>)
          return std::bit_cast<uint64_t>(left) == std::bit_cast<uint64_t>(right);
        else
          return left == right;
      },
      a.value_);
}

std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> names(1);
  for (size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '\\' && i + 1 < path.size()) {
      if (path[++i] != 'e') names.back() += path[i];
    } else if (path[i] == '/') {
      names.emplace_back();
    } else {
      names.back() += path[i];
    }
  }
  return names;
}

std::string join_path(std::string_view path, std::string_view name) {
  std::string joined(path);
  if (!joined.empty()) joined += '/';
  // An empty name needs a mark, because the empty path is the value itself.
  if (name.empty()) joined += "\\e";
  for (const char c : name) {
    if (c == '/' || c == '\\') joined += '\\';
    joined += c;
  }
  return joined;
}

}  // namespace engram::idf
