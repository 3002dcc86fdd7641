// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/memory_id.h"

#include <algorithm>
#include <charconv>
#include <functional>

#include "ltm/core/printable.h"
#include "ltm/core/utf8.h"

namespace engram::ltm {

namespace {

Status check_name(std::string_view name, size_t number, size_t count) {
  if (name.empty()) return invalid_argument("memory ID: name {} of {} is empty", number, count);
  if (!is_utf8(name))
    return invalid_argument("memory ID: name {} of {} is no UTF-8", number, count);
  return {};
}

/// Mixes every bit of `value` into the whole of `hash`, so that the order of the parts counts.
size_t mixed(size_t hash, uint64_t value) {
  uint64_t bits = (hash + 0x9e3779b97f4a7c15u) ^ value;
  bits = (bits ^ (bits >> 32)) * 0xd6e8feb86659fd93u;
  bits = (bits ^ (bits >> 29)) * 0xbf58476d1ce4e5b9u;
  return static_cast<size_t>(bits ^ (bits >> 32));
}

}  // namespace

const MemoryId::Names MemoryId::kNoNames;

Result<MemoryId> MemoryId::parse(std::string_view text) {
  if (text.empty()) return MemoryId();
  std::vector<std::string> parts = idf::split_path(text);
  if (parts.size() > kNameLevels + 2)
    return invalid_argument("memory ID '{}': has {} parts, at most 6 are known", text,
                            parts.size());
  // The number of parts alone decides their levels: a name may look like a time.
  std::optional<Time> time;
  std::optional<int32_t> index;
  if (parts.size() == kNameLevels + 2) {
    const std::string& part = parts.back();
    int32_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || value < 0)
      return invalid_argument("memory ID '{}': '{}' is no instance index", text, part);
    index = value;
    parts.pop_back();
  }
  if (parts.size() == kNameLevels + 1) {
    auto parsed = parse_time(parts.back());
    if (!parsed.ok()) return parsed.status().with_context(fmt::format("memory ID '{}'", text));
    time = *parsed;
    parts.pop_back();
  }
  ENGRAM_ASSIGN_OR_RETURN(MemoryId id, from_names(std::move(parts)));
  id.time_ = time;
  id.index_ = index;
  return id;
}

Result<MemoryId> MemoryId::from_names(std::vector<std::string> names) {
  if (names.size() > kNameLevels)
    return invalid_argument("memory ID: has {} names, at most {} are known", names.size(),
                            kNameLevels);
  for (size_t i = 0; i < names.size(); ++i)
    ENGRAM_RETURN_IF_ERROR(check_name(names[i], i + 1, names.size()));
  MemoryId id;
  id.set_names(std::move(names));
  return id;
}

void MemoryId::set_names(Names names) {
  names_ = names.empty() ? nullptr : std::make_shared<const Names>(std::move(names));
}

Result<MemoryId> MemoryId::from_data(const idf::Data& data) {
  if (const auto* text = data.get_if<std::string>()) return parse(*text);
  return invalid_argument("memory ID: found {}, needs a string", data.kind_name());
}

MemoryId MemoryId::parent() const {
  ENGRAM_CHECK(depth() > 0, "the empty ID has no parent");
  MemoryId id = *this;
  if (index_)
    id.index_.reset();
  else if (time_)
    id.time_.reset();
  else
    id.set_names({names().begin(), names().end() - 1});
  return id;
}

Result<MemoryId> MemoryId::child(std::string_view name) const {
  ENGRAM_CHECK(!has_entity(), "'{}' has snapshots below it, no names", to_string());
  ENGRAM_RETURN_IF_ERROR(check_name(name, names().size() + 1, names().size() + 1));
  MemoryId id = *this;
  Names all = names();
  all.emplace_back(name);
  id.set_names(std::move(all));
  return id;
}

MemoryId MemoryId::at(Time time) const {
  MemoryId id = entity();
  id.time_ = time;
  return id;
}

MemoryId MemoryId::instance(int32_t index) const {
  ENGRAM_CHECK(time_.has_value(), "'{}' is no snapshot", to_string());
  ENGRAM_CHECK(index >= 0, "'{}': {} is no instance index", to_string(), index);
  MemoryId id = *this;
  id.index_ = index;
  return id;
}

MemoryId MemoryId::entity() const {
  ENGRAM_CHECK(has_entity(), "'{}' has no entity", to_string());
  MemoryId id;
  id.names_ = names_;
  return id;
}

bool MemoryId::is_prefix_of(const MemoryId& other) const {
  const Names& own = names();
  const Names& others = other.names();
  if (own.size() > others.size()) return false;
  if (names_ != other.names_ && !std::equal(own.begin(), own.end(), others.begin())) return false;
  if (time_ && time_ != other.time_) return false;
  return !index_ || index_ == other.index_;
}

std::string MemoryId::to_string() const {
  std::string text;
  for (const std::string& name : names()) text = idf::join_path(text, name);
  if (time_) text += "/" + engram::to_string(*time_);
  if (index_) text += fmt::format("/{}", *index_);
  return text;
}

std::string MemoryId::printable() const {
  return engram::printable(to_string());
}

size_t MemoryId::hash() const {
  size_t hash = depth();
  for (const std::string& name : names()) hash = mixed(hash, std::hash<std::string>()(name));
  if (time_) hash = mixed(hash, static_cast<uint64_t>(to_ns(*time_)));
  if (index_) hash = mixed(hash, static_cast<uint64_t>(*index_));
  return hash;
}

}  // namespace engram::ltm
