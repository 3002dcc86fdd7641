// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/entity_pattern.h"

namespace engram::ltm {

namespace {

/// Removes the next level from `rest`, up to a `/` that has no backslash before it, and returns it.
std::string_view take_level(std::string_view& rest) {
  size_t end = 0;
  while (end < rest.size() && rest[end] != '/') end += rest[end] == '\\' ? 2 : 1;
  end = std::min(end, rest.size());
  const std::string_view level = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return level;
}

}  // namespace

Result<EntityPattern> EntityPattern::parse(std::string_view text) {
  EntityPattern pattern;
  pattern.text_ = text;
  std::string_view rest = text;
  size_t level = 0;
  do {
    if (level == pattern.levels_.size())
      return invalid_argument("entity pattern '{}': has more than {} levels", text, level);
    auto parsed = NamePattern::parse(take_level(rest));
    if (!parsed.ok()) return parsed.status().with_context(fmt::format("entity pattern '{}'", text));
    pattern.levels_[level++] = *std::move(parsed);
  } while (!rest.empty());
  return pattern;
}

bool EntityPattern::matches(const MemoryId& entity) const {
  ENGRAM_CHECK(entity.has_entity(), "'{}' is no entity", entity.to_string());
  for (size_t i = 0; i < levels_.size(); ++i)
    if (!levels_[i].matches(entity.names()[i])) return false;
  return true;
}

}  // namespace engram::ltm
