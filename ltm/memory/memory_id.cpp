// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/memory_id.h"

#include <charconv>

#include "ltm/idf/data.h"

namespace engram::ltm {

namespace {

/// Bytes of the UTF-8 character that `text` starts with; zero where there is none.
size_t utf8_length(std::string_view text) {
  const auto lead = static_cast<uint8_t>(text.front());
  if (lead < 0x80) return 1;
  const size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return 0;
  uint32_t character = lead & (0x7fu >> length);
  for (size_t i = 1; i < length; ++i) {
    const auto next = static_cast<uint8_t>(text[i]);
    if ((next & 0xc0) != 0x80) return 0;
    character = character << 6 | (next & 0x3f);
  }
  const bool is_overlong =
      (length == 3 && character < 0x800) || (length == 4 && character < 0x10000);
  const bool is_surrogate = character >= 0xd800 && character < 0xe000;
  return is_overlong || is_surrogate || character > 0x10ffff ? 0 : length;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

Result<MemoryId> MemoryId::parse(std::string_view text) {
  if (text.empty()) return MemoryId();
  std::vector<std::string> parts = idf::split_path(text);
  if (parts.size() > kNameLevels + 2)
    return invalid_argument("memory ID '{}': has {} parts, at most 6 are known", text,
                            parts.size());
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
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty())
      return invalid_argument("memory ID: name {} of {} is empty", i + 1, names.size());
    if (!is_utf8(names[i]))
      return invalid_argument("memory ID: name {} of {} is no UTF-8", i + 1, names.size());
  }
  MemoryId id;
  id.names_ = std::move(names);
  return id;
}

MemoryId MemoryId::at(Time time) const {
  MemoryId id = entity();
  id.time_ = time;
  return id;
}

MemoryId MemoryId::instance(int32_t index) const {
  ENGRAM_CHECK(time_.has_value(), "'{}' is no snapshot", to_string());
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

bool MemoryId::contains(const MemoryId& other) const {
  if (names_.size() > other.names_.size()) return false;
  for (size_t i = 0; i < names_.size(); ++i)
    if (names_[i] != other.names_[i]) return false;
  if (time_ && time_ != other.time_) return false;
  return !index_ || index_ == other.index_;
}

std::string MemoryId::to_string() const {
  std::string text;
  for (const std::string& name : names_) text = idf::join_path(text, name);
  if (time_) text += "/" + engram::to_string(*time_);
  if (index_) text += fmt::format("/{}", *index_);
  return text;
}

}  // namespace engram::ltm
