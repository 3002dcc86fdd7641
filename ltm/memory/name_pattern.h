// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace re2 {
class RE2;
}

namespace engram::ltm {

/// Matches the names of one level of the hierarchy: all names, one name, or a regular expression
/// (RE2: linear time, bounded memory) that must match the whole name.
///
/// An expression is compiled once; copies share it.
/// Threading: immutable, const-parallel.
/// Source: docs/query.md.
class NamePattern {
 public:
  enum class Kind { kAll, kName, kRegex };

  /// Matches every name.
  NamePattern() = default;

  /// Matches exactly this name, whatever characters it has.
  /// Errors: kInvalidArgument where it is empty or no UTF-8.
  static Result<NamePattern> name(std::string_view name);

  /// Reads a pattern. `.*` is every name; a text without `. * + ? ( ) [ ] { } | ^ $` is one name;
  /// any other text is an expression. A backslash makes the punctuation or space after it literal.
  /// An expression that equals a name letter by letter ("cam.1") matches that name too.
  /// Errors: kInvalidArgument where the text is empty, no UTF-8, a broken expression, one that
  /// needs more than 1 MiB, or one that quotes by `\Q`.
  static Result<NamePattern> parse(std::string_view text);

  [[nodiscard]] Kind kind() const { return kind_; }

  /// The name for kName; otherwise the expression without needless escapes.
  [[nodiscard]] const std::string& text() const { return text_; }

  [[nodiscard]] bool matches(std::string_view name) const;

  /// A text that parse reads back to the same pattern. `/`, `;`, `@` and spaces at the ends are
  /// escaped, so that the levels of a query stay apart.
  [[nodiscard]] std::string to_string() const;

  /// Patterns of the same kind and text are equal.
  friend bool operator==(const NamePattern& a, const NamePattern& b) {
    return a.kind_ == b.kind_ && a.text_ == b.text_;
  }

 private:
  NamePattern(Kind kind, std::string text) : kind_(kind), text_(std::move(text)) {}

  Kind kind_ = Kind::kAll;
  std::string text_ = ".*";                     ///< The value of text().
  std::shared_ptr<const re2::RE2> expression_;  ///< Only for kRegex.
};

}  // namespace engram::ltm
