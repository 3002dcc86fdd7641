// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ltm/core/printable.h"
#include "ltm/core/utf8.h"
#include "speech/program/program.h"

namespace engram::speech {

namespace {

/// Characters of a value that needs no quotes.
bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-.,:/+").find(c) != std::string_view::npos;
}

/// Reads the text form from left to right.
class ProgramParser {
 public:
  explicit ProgramParser(std::string_view text) : text_(text) {}

  Result<Program> read_all() {
    ENGRAM_ASSIGN_OR_RETURN(Program program, read_program(0));
    skip_spaces();
    if (at_ < text_.size()) return wrong("the end, '|' or NAME=VALUE");
    return program;
  }

 private:
  Result<Program> read_program(int depth) {
    if (depth >= Program::kMaxDepth)
      return wrong(fmt::format("at most {} programs in each other", Program::kMaxDepth));
    Program program;
    const std::string name = read_name();
    const auto source = source_named(name);
    if (!source)
      return wrong_name(name, "executions, words, plans, refusals, drives, things or robot");
    program.source = *source;
    ENGRAM_RETURN_IF_ERROR(read_filters(program, depth));
    while (skip_spaces(), take('|')) {
      ENGRAM_RETURN_IF_ERROR(read_step(program, depth));
    }
    return program;
  }

  Status read_filters(Program& program, int depth) {
    while (skip_spaces(), at_ < text_.size() && text_[at_] != '|' && text_[at_] != ')') {
      const std::string name = read_name();
      const auto key = filter_named(name);
      if (!key) return wrong_name(name, "a filter, as skill=pick, or '|'");
      if (!take('=')) return wrong("'=' after " + name);
      ENGRAM_ASSIGN_OR_RETURN(Argument value, read_value(depth));
      program.filters.push_back({*key, std::move(value)});
      if (program.filters.size() > Program::kMaxParts) return wrong("fewer filters");
    }
    return {};
  }

  Status read_step(Program& program, int depth) {
    const std::string name = read_name();
    const auto kind = step_named(name);
    if (!kind) return wrong_name(name, "a step, as last, count or why");
    ProgramStep step{*kind, {}};
    if (take('=')) {
      ENGRAM_ASSIGN_OR_RETURN(step.argument, read_value(depth));
    }
    program.steps.push_back(std::move(step));
    if (program.steps.size() > Program::kMaxParts) return wrong("fewer steps");
    return {};
  }

  Result<Argument> read_value(int depth) {
    if (take('"')) return read_quoted();
    if (take('(')) {
      ENGRAM_ASSIGN_OR_RETURN(Program inner, read_program(depth + 1));
      skip_spaces();
      if (!take(')')) return wrong("')'");
      return Argument{{}, std::make_shared<const Program>(std::move(inner))};
    }
    const size_t begin = at_;
    while (at_ < text_.size() && is_plain(text_[at_])) ++at_;
    if (begin == at_) return wrong("a value: a word, a text in quotes or a program in parentheses");
    return Argument{std::string(text_.substr(begin, at_ - begin)), nullptr};
  }

  Result<Argument> read_quoted() {
    Argument value;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      value.text += text_[at_++];
    }
    if (!take('"')) return wrong("'\"' at the end of a text");
    if (value.text.empty()) return wrong("a text that is not empty");
    return value;
  }

  std::string read_name() {
    skip_spaces();
    const size_t begin = at_;
    while (at_ < text_.size() && ((text_[at_] >= 'a' && text_[at_] <= 'z') || text_[at_] == '_'))
      ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  }

  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t'))
      ++at_;
  }

  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  [[nodiscard]] Status wrong(const std::string& needed) const {
    const std::string_view found = text_.substr(std::min(at_, text_.size())).substr(0, 20);
    return invalid_argument("program: found '{}' at {}, needs {}",
                            found.empty() ? "the end" : printable(found), at_, needed);
  }

  /// A name that was read, and that nothing has.
  [[nodiscard]] Status wrong_name(const std::string& name, const char* needed) const {
    if (name.empty()) return wrong(needed);
    return invalid_argument("program: found '{}' before {}, needs {}", printable(name), at_,
                            needed);
  }

  std::string_view text_;
  size_t at_ = 0;
};

std::string argument_text(const Argument& argument) {
  if (argument.program != nullptr) return "(" + argument.program->to_string() + ")";
  if (!argument.text.empty() && std::all_of(argument.text.begin(), argument.text.end(), is_plain))
    return argument.text;
  std::string quoted = "\"";
  for (const char c : argument.text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

Result<Program> Program::parse(std::string_view text) {
  if (text.size() > kMaxTextBytes)
    return invalid_argument("program: found {} bytes, needs at most {}", text.size(),
                            kMaxTextBytes);
  if (!is_utf8(text)) return invalid_argument("program: needs valid UTF-8");
  ENGRAM_ASSIGN_OR_RETURN(Program program, ProgramParser(text).read_all());
  ENGRAM_RETURN_IF_ERROR(program.validate());
  return program;
}

std::string Program::to_string() const {
  std::string text(name_of(source));
  for (const ProgramFilter& filter : filters)
    text += fmt::format(" {}={}", name_of(filter.key), argument_text(filter.value));
  for (const ProgramStep& step : steps) {
    text += fmt::format(" | {}", name_of(step.kind));
    if (step.argument) text += "=" + argument_text(*step.argument);
  }
  return text;
}

}  // namespace engram::speech
