// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace engram::idf {

/// The maximum length of a line of generated code. Unit: columns.
inline constexpr size_t kCodeColumns = 100;

/// A C++ expression that can be laid out over several lines: `prefix open part, part close`.
struct CodeExpression {
  std::string open;
  std::vector<CodeExpression> parts = {};
  std::string close = "";
  std::vector<CodeExpression> prefix = {};  ///< At most one.
  std::string_view separator = ",";

  /// The expression on one line.
  [[nodiscard]] std::string flat() const;

  /// Appends the expression to `code`. Parts get lines of their own where they do not fit after the
  /// existing text; `behind` columns stay free for the text that follows.
  void lay_out(std::string& code, size_t indent, size_t behind) const;
};

/// A string literal of exactly these bytes, whatever they are, with one piece per line of the text.
[[nodiscard]] CodeExpression cpp_literal(std::string_view text);

/// `text` as lines that start with "/// "; empty for an empty text. Nothing in it can end the
/// comment, join it with the next line, or reverse the direction of the text.
[[nodiscard]] std::string cpp_comment(std::string_view text, size_t indent);

/// The shortest text that C++ reads as the same number.
[[nodiscard]] std::string cpp_number(double number);
[[nodiscard]] std::string cpp_number(float number);
[[nodiscard]] std::string cpp_number(int64_t number);
[[nodiscard]] std::string cpp_number(uint64_t number);

}  // namespace engram::idf
