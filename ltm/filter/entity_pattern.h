// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "ltm/memory/memory_id.h"
#include "ltm/memory/name_pattern.h"

namespace engram::ltm {

/// Matches entities by their names, level by level, with the patterns of a query:
/// "Vision/RGB/.*/cam". Missing levels at the end match every name.
///
/// Threading: immutable, const-parallel.
/// Source: docs/query.md.
class EntityPattern {
 public:
  /// Matches every entity.
  EntityPattern() = default;

  /// Parses up to four name patterns joined by `/`. A `/` inside a name is written `\/`.
  /// Errors: kInvalidArgument naming the text and the level.
  static Result<EntityPattern> parse(std::string_view text);

  /// Needs an entity or deeper (checked).
  [[nodiscard]] bool matches(const MemoryId& entity) const;

  /// Whether it may match an entity of this memory.
  [[nodiscard]] bool may_match_in(std::string_view memory) const {
    return levels_.front().matches(memory);
  }

  /// The text as it was parsed.
  [[nodiscard]] const std::string& to_string() const { return text_; }

  friend bool operator==(const EntityPattern&, const EntityPattern&) = default;

 private:
  std::array<NamePattern, MemoryId::kNameLevels> levels_;
  std::string text_ = ".*";
};

}  // namespace engram::ltm
