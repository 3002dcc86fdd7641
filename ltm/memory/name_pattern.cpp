// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/name_pattern.h"

#include <re2/re2.h>

#include <optional>

#include "ltm/core/utf8.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kRegexCharacters = ".*+?()[]{}|^$";
/// The characters with a meaning in the text form of a query. A backslash before them is not part
/// of the expression.
constexpr std::string_view kStructure = "/;@ ";
constexpr int64_t kMaxExpressionBytes = 1 << 20;

bool is_one_of(char c, std::string_view characters) {
  return characters.find(c) != std::string_view::npos;
}

bool is_plain_punctuation(char c) {
  const auto byte = static_cast<unsigned char>(c);
  const bool is_word = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  return byte < 0x80 && c != '_' && !is_word;
}

/// The name that `text` spells; nothing where it is an expression.
std::optional<std::string> literal(std::string_view text) {
  std::string name;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\') {
      if (++i == text.size() || !is_plain_punctuation(text[i])) return std::nullopt;
    } else if (is_one_of(text[i], kRegexCharacters)) {
      return std::nullopt;
    }
    name += text[i];
  }
  return name;
}

/// The expression without backslashes before the characters of kStructure.
std::string without_structure_escapes(std::string_view text) {
  std::string expression;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      if (!is_one_of(text[i + 1], kStructure)) expression += '\\';
      ++i;
    }
    expression += text[i];
  }
  return expression;
}

/// \Q makes backslashes literal, so unescaping and printing would need to know about quotations.
bool has_quotation(std::string_view expression) {
  for (size_t i = 0; i + 1 < expression.size(); ++i) {
    if (expression[i] != '\\') continue;
    if (expression[++i] == 'Q') return true;
  }
  return false;
}

Result<std::shared_ptr<const re2::RE2>> compile(const std::string& expression) {
  re2::RE2::Options options(re2::RE2::Quiet);
  options.set_max_mem(kMaxExpressionBytes);
  options.set_never_capture(true);
  auto compiled = std::make_shared<const re2::RE2>(expression, options);
  if (compiled->ok()) return compiled;
  return invalid_argument("name pattern '{}' is no regular expression: {}", expression,
                          compiled->error());
}

Status check_text(std::string_view text) {
  if (text.empty()) return invalid_argument("a name pattern is empty: needs a name or '.*'");
  if (!is_utf8(text)) return invalid_argument("name pattern '{}': is no UTF-8", text);
  return {};
}

}  // namespace

Result<NamePattern> NamePattern::name(std::string_view name) {
  ENGRAM_RETURN_IF_ERROR(check_text(name));
  return NamePattern(Kind::kName, std::string(name));
}

Result<NamePattern> NamePattern::parse(std::string_view text) {
  ENGRAM_RETURN_IF_ERROR(check_text(text));
  if (text == ".*") return NamePattern();
  if (auto name = literal(text)) return NamePattern(Kind::kName, *std::move(name));
  NamePattern pattern(Kind::kRegex, without_structure_escapes(text));
  if (has_quotation(pattern.text_))
    return invalid_argument(
        "name pattern '{}': quotes by '\\Q', needs a backslash before each "
        "character instead",
        text);
  ENGRAM_ASSIGN_OR_RETURN(pattern.expression_, compile(pattern.text_));
  return pattern;
}

bool NamePattern::matches(std::string_view name) const {
  if (kind_ == Kind::kAll) return true;
  if (text_ == name) return true;
  return kind_ == Kind::kRegex &&
         re2::RE2::FullMatch(re2::StringPiece(name.data(), name.size()), *expression_);
}

std::string NamePattern::to_string() const {
  if (kind_ == Kind::kAll) return text_;
  std::string text;
  for (size_t i = 0; i < text_.size(); ++i) {
    const char c = text_[i];
    const bool is_pair = kind_ == Kind::kRegex && c == '\\';
    const bool is_end_space = c == ' ' && (i == 0 || i + 1 == text_.size());
    const bool is_special = kind_ == Kind::kName && (c == '\\' || is_one_of(c, kRegexCharacters));
    if (is_special || is_end_space || (c != ' ' && is_one_of(c, kStructure))) text += '\\';
    text += c;
    if (is_pair) text += text_[++i];
  }
  return text;
}

}  // namespace engram::ltm
