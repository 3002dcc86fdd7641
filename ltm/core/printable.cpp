// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/printable.h"

#include <fmt/format.h>

#include "ltm/core/utf8.h"

namespace engram {

namespace {

bool is_control(char32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

/// Marks, embeddings, overrides and isolates of right-to-left text, and separators of lines.
bool turns_text(char32_t code) {
  return code == 0x61c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

enum class Form { kLine, kLines, kJson };

std::string escaped(char32_t code, Form form) {
  const auto number = static_cast<uint32_t>(code);
  if (form == Form::kJson) return fmt::format("\\u{:04x}", number);
  switch (code) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      break;
  }
  return number < 0x100 ? fmt::format("\\x{:02x}", number) : fmt::format("\\u{:04x}", number);
}

std::string with_escapes(std::string_view text, Form form) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Utf8Character next = first_character(text);
    const size_t bytes = next.bytes == 0 ? 1 : next.bytes;
    if (next.bytes == 0)
      out += escaped(static_cast<uint8_t>(text.front()), form);
    else if (form != Form::kLine && (next.code == '\n' || next.code == '\t'))
      out += text.front();
    else if (is_control(next.code) || turns_text(next.code))
      out += escaped(next.code, form);
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) {
  return with_escapes(text, Form::kLine);
}

std::string printable_lines(std::string_view text) {
  return with_escapes(text, Form::kLines);
}

std::string printable_json(std::string_view json) {
  return with_escapes(json, Form::kJson);
}

}  // namespace engram
