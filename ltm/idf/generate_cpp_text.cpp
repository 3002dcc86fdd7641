// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_cpp_text.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <limits>

namespace engram::idf {

namespace {

/// The size of a character at the start of `text` that changes the direction of text; otherwise
/// zero. Compilers warn of such characters, and they can make code look different from what it is.
size_t direction_bytes(std::string_view text) {
  constexpr std::array<std::string_view, 12> kMarks{"\u200e", "\u200f", "\u202a", "\u202b",
                                                    "\u202c", "\u202d", "\u202e", "\u2066",
                                                    "\u2067", "\u2068", "\u2069", "\u061c"};
  for (const std::string_view mark : kMarks)
    if (text.starts_with(mark)) return mark.size();
  return 0;
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

std::string octal(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) text += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
  return text;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (const size_t count = direction_bytes(text.substr(i))) {
      result += octal(text.substr(i, count));
      i += count - 1;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '"' || c == '\\' || (c == '?' && i > 0 && text[i - 1] == '?')) {
      result += {'\\', c};
    } else if (is_control(c)) {
      result += octal(text.substr(i, 1));
    } else {
      result += c;
    }
  }
  return result;
}

/// One line of a comment without such characters.
std::string tamed(std::string_view line) {
  std::string result;
  for (size_t i = 0; i < line.size(); ++i) {
    if (const size_t count = direction_bytes(line.substr(i)))
      i += count - 1;
    else
      result += is_control(line[i]) ? ' ' : line[i];
  }
  const size_t end = result.find_last_not_of(' ');
  result.resize(end == std::string::npos ? 0 : end + 1);
  if (result.ends_with('\\') || result.ends_with("?\?/")) result += " .";
  return result;
}

size_t column_of(std::string_view code) {
  const size_t line = code.rfind('\n');
  return code.size() - (line == std::string_view::npos ? 0 : line + 1);
}

/// A number in C++ is floating-point only with a point or an exponent.
std::string with_point(std::string text) {
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace

std::string CodeExpression::flat() const {
  std::string text;
  for (const CodeExpression& before : prefix) text += before.flat();
  text += open;
  for (size_t i = 0; i < parts.size(); ++i)
    text += (i == 0 ? std::string() : std::string(separator) + " ") + parts[i].flat();
  return text + close;
}

void CodeExpression::lay_out(std::string& code, size_t indent, size_t behind) const {
  const std::string on_one_line = flat();
  if (parts.empty() || column_of(code) + on_one_line.size() + behind <= kCodeColumns) {
    code += on_one_line;
    return;
  }
  for (const CodeExpression& before : prefix) before.lay_out(code, indent, open.size());
  code += open;
  // The parts of braces and of string literals start on the same line; arguments start on a new
  // line.
  const bool is_call = open.ends_with('(');
  const size_t inner = is_call ? indent + 4 : column_of(code);
  for (size_t i = 0; i < parts.size(); ++i) {
    const bool is_last = i + 1 == parts.size();
    if (is_call || i > 0) code += '\n' + std::string(inner, ' ');
    parts[i].lay_out(code, inner, is_last ? close.size() + behind : 1);
    if (!is_last) code += separator;
  }
  code += close;
}

CodeExpression cpp_literal(std::string_view text) {
  CodeExpression literal{.open = "", .separator = ""};
  while (true) {
    const size_t end = text.find('\n');
    const bool is_last = end == std::string_view::npos || end + 1 == text.size();
    const std::string_view line = is_last ? text : text.substr(0, end + 1);
    literal.parts.push_back({.open = fmt::format("\"{}\"", escaped(line))});
    if (is_last) break;
    text.remove_prefix(end + 1);
  }
  if (literal.parts.size() == 1) return literal.parts.front();
  return literal;
}

std::string cpp_comment(std::string_view text, size_t indent) {
  std::string comment;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    while (line.starts_with(' ') || line.starts_with('\t')) line.remove_prefix(1);
    const std::string tame = tamed(line);
    comment += fmt::format("{:{}}///{}{}\n", "", indent, tame.empty() ? "" : " ", tame);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return comment;
}

std::string cpp_number(double number) {
  return with_point(fmt::format("{}", number));
}

std::string cpp_number(float number) {
  return with_point(fmt::format("{}", number)) + "f";
}

std::string cpp_number(int64_t number) {
  // C++ has no negative literals: the smallest number would be the negative of one that is too
  // large.
  if (number == std::numeric_limits<int64_t>::min()) return fmt::format("{} - 1", number + 1);
  if (number == std::numeric_limits<int32_t>::min()) return fmt::format("{} - 1", number + 1);
  return fmt::format("{}", number);
}

std::string cpp_number(uint64_t number) {
  return fmt::format("{}u", number);
}

}  // namespace engram::idf
