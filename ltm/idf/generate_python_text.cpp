// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace engram::idf {

namespace {

constexpr size_t kStep = 4;

/// The number of bytes of the UTF-8 character at the start of `text`; zero where there is none.
size_t character_size(std::string_view text) {
  const auto byte = [text](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < size) return 0;
  uint32_t code = first & (0x7fu >> size);
  for (size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fu);
  }
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  const bool is_overlong = code < (size == 4 ? 0x10000u : size == 3 ? 0x800u : 0x80u);
  return is_surrogate || is_overlong || code > 0x10ffff ? 0 : size;
}

/// Escapes what a literal cannot hold; quotes stay.
std::string escaped_in_python(std::string_view text) {
  std::string made;
  while (!text.empty()) {
    const size_t size = character_size(text);
    const auto byte = static_cast<unsigned char>(text[0]);
    if (size == 0)
      made += fmt::format("\\udc{:02x}", byte);
    else if (text[0] == '\n')
      made += "\\n";
    else if (text[0] == '\\')
      made += "\\\\";
    else if (byte < 0x20 || byte == 0x7f)
      made += fmt::format("\\x{:02x}", byte);
    else
      made += text.substr(0, size);
    text.remove_prefix(std::max<size_t>(size, 1));
  }
  return made;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Adds the words of a line, on lines of at most `width`.
void add_wrapped(std::string_view text, size_t width, std::vector<std::string>& lines) {
  std::string line;
  for (const std::string_view word : split(text, ' ')) {
    if (word.empty()) continue;
    const std::string made = replaced(escaped_in_python(word), R"(""")", R"(\"\"\")");
    if (!line.empty() && line.size() + 1 + made.size() > width) {
      lines.push_back(std::move(line));
      line.clear();
    }
    line += (line.empty() ? "" : " ") + made;
  }
  lines.push_back(std::move(line));
}

std::string one_line(const PythonExpression& expression) {
  std::string made = expression.head;
  for (size_t i = 0; i < expression.parts.size(); ++i)
    made += (i == 0 ? "" : ", ") + one_line(expression.parts[i]);
  if (expression.close == '\0') return made;
  const std::string& head = expression.head;
  const bool is_tuple = head == "(" || head.ends_with("=(") || head.ends_with(" (");
  if (is_tuple && expression.parts.size() == 1) made += ',';
  return made + expression.close;
}

}  // namespace

PythonExpression python_call(std::string head, std::vector<PythonExpression> parts) {
  const char close = head.back() == '(' ? ')' : head.back() == '[' ? ']' : '}';
  return {std::move(head), std::move(parts), close};
}

std::string to_string(const PythonExpression& expression, size_t indent, size_t used) {
  const std::string line = one_line(expression);
  if (expression.parts.empty() || used + line.size() <= kPythonLine) return line;
  std::string made = expression.head + "\n";
  const size_t inner = indent + kStep;
  for (const PythonExpression& part : expression.parts)
    made += std::string(inner, ' ') + to_string(part, inner, inner + 1) + ",\n";
  return made + std::string(indent, ' ') + expression.close;
}

std::string python_string(std::string_view text) {
  return '"' + replaced(escaped_in_python(text), R"(")", R"(\")") + '"';
}

std::string python_docstring(std::string_view text, size_t indent) {
  std::vector<std::string> lines;
  const std::string margin(indent, ' ');
  for (const std::string_view line : split(text, '\n'))
    add_wrapped(line, kPythonLine - indent - 6, lines);
  if (lines.size() == 1) {
    if (lines[0].ends_with('"')) lines[0] += ' ';
    return fmt::format("{}\"\"\"{}\"\"\"\n", margin, lines[0]);
  }
  std::string made = margin + "\"\"\"";
  for (size_t i = 0; i < lines.size(); ++i)
    made += (i == 0 || lines[i].empty() ? "" : margin) + lines[i] + "\n";
  return made + margin + "\"\"\"\n";
}

}  // namespace engram::idf
