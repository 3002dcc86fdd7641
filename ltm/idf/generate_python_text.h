// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace engram::idf {

/// The maximum length of a line of generated Python code. Unit: columns.
inline constexpr size_t kPythonLine = 100;

/// A call, tuple or list; without brackets, any text.
struct PythonExpression {
  std::string head;  ///< The text up to the bracket: "name=(".
  std::vector<PythonExpression> parts = {};
  char close = '\0';  ///< The closing bracket; zero: `head` is the whole expression.
};

/// An expression of `head`, which ends with its bracket, as in python_call("f(", {...}).
[[nodiscard]] PythonExpression python_call(std::string head, std::vector<PythonExpression> parts);

/// The expression on one line where it fits after `used` columns, otherwise with one part per line,
/// inside `indent`.
[[nodiscard]] std::string to_string(const PythonExpression& expression, size_t indent, size_t used);

/// A string literal that Python reads as `text`. Bytes that are no UTF-8 become what Python's
/// "surrogateescape" makes of them.
[[nodiscard]] std::string python_string(std::string_view text);

/// A documentation string inside `indent`, with its newline. Words are wrapped, and nothing in
/// `text` can end it.
[[nodiscard]] std::string python_docstring(std::string_view text, size_t indent);

}  // namespace engram::idf
