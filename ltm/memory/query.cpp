// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/query.h"

#include <re2/re2.h>

#include <charconv>
#include <limits>
#include <vector>

namespace engram::ltm {

namespace {

constexpr std::string_view kRegexCharacters = ".*+?()[]{}|^$\\";
constexpr int64_t kIndexLimit = 1'000'000'000;

/// True where a backslash before it makes the last character a part of a name.
bool is_end_escaped(std::string_view text) {
  text.remove_suffix(1);
  size_t backslashes = 0;
  for (; text.ends_with('\\'); text.remove_suffix(1)) ++backslashes;
  return backslashes % 2 == 1;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ' && !is_end_escaped(text)) text.remove_suffix(1);
  return text;
}

std::optional<int64_t> parse_integer(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// Splits at "/" but not at "\/"; the escape stays, `\/` matches a slash in an expression too.
std::vector<std::string> split_levels(std::string_view text) {
  std::vector<std::string> levels(1);
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      levels.back() += text[i];
      levels.back() += text[++i];
    } else if (text[i] == '/') {
      levels.emplace_back();
    } else {
      levels.back() += text[i];
    }
  }
  return levels;
}

Result<Selector> parse_index_range(std::string_view text) {
  const size_t dots = text.find("..");
  if (dots != std::string_view::npos) {
    const auto first = parse_integer(text.substr(0, dots));
    const auto last = parse_integer(text.substr(dots + 2));
    if (first && last) return Selector(select::IndexRange{*first, *last});
  }
  return invalid_argument("'{}' is no index range: needs 'FIRST..LAST', as in '-3..-1'", text);
}

Result<Selector> parse_range(std::string_view text, size_t dots) {
  const std::string_view first = trim(text.substr(0, dots));
  const std::string_view last = trim(text.substr(dots + 2));
  const auto first_index = parse_integer(first);
  const auto last_index = parse_integer(last);
  const auto is_index = [](std::optional<int64_t> value) {
    return value && *value > -kIndexLimit && *value < kIndexLimit;
  };
  if (is_index(first_index) && is_index(last_index))
    return Selector(select::IndexRange{*first_index, *last_index});
  ENGRAM_ASSIGN_OR_RETURN(const Time from, parse_time(first));
  ENGRAM_ASSIGN_OR_RETURN(const Time to, parse_time(last));
  if (to < from) return invalid_argument("time range '{}' ends before it starts", text);
  return Selector(select::TimeRange{from, to});
}

Result<Selector> parse_nearest(std::string_view text) {
  const size_t tilde = text.find('~');
  ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(trim(text.substr(0, tilde))));
  if (tilde == std::string_view::npos) return Selector(select::Nearest{.time = time});
  ENGRAM_ASSIGN_OR_RETURN(const Duration tolerance, parse_duration(trim(text.substr(tilde + 1))));
  if (tolerance < Duration(0)) return invalid_argument("tolerance '{}' is negative", text);
  return Selector(select::Nearest{time, tolerance});
}

Result<Selector> parse_selector(std::string_view text) {
  if (text == "all") return Selector(select::All{});
  if (text == "latest") return Selector(select::Latest{});
  if (take_prefix(text, "latest:")) {
    const auto count = parse_integer(text);
    if (count && *count > 0) return Selector(select::Latest{*count});
    return invalid_argument("'latest:{}': needs a number above zero", text);
  }
  if (take_prefix(text, "last:")) {
    ENGRAM_ASSIGN_OR_RETURN(const Duration duration, parse_duration(text));
    if (duration < Duration(0))
      return invalid_argument("'last:{}': needs a positive duration", text);
    return Selector(select::LastDuration{duration});
  }
  if (take_prefix(text, "nearest:")) return parse_nearest(text);
  if (take_prefix(text, "index:")) return parse_index_range(text);
  for (const bool is_inclusive : {true, false}) {
    if (!take_prefix(text, is_inclusive ? "at-or-before:" : "before:")) continue;
    ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(text));
    return Selector(select::Before{time, is_inclusive});
  }
  if (take_prefix(text, "after:")) {
    ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(text));
    return Selector(select::After{time});
  }
  if (text.starts_with('+')) {
    ENGRAM_ASSIGN_OR_RETURN(const Duration offset, parse_duration(text));
    return Selector(select::Ahead{offset});
  }
  const bool is_time = take_prefix(text, "time:");
  const size_t dots = text.find("..");
  if (dots != std::string_view::npos && !is_time) return parse_range(text, dots);
  if (dots != std::string_view::npos) {
    ENGRAM_ASSIGN_OR_RETURN(const Time from, parse_time(trim(text.substr(0, dots))));
    ENGRAM_ASSIGN_OR_RETURN(const Time to, parse_time(trim(text.substr(dots + 2))));
    if (to < from) return invalid_argument("time range '{}' ends before it starts", text);
    return Selector(select::TimeRange{from, to});
  }
  ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(text));
  return Selector(select::At{time});
}

struct SelectorPrinter {
  std::string operator()(select::All) const { return "all"; }
  std::string operator()(select::Latest s) const { return fmt::format("latest:{}", s.count); }
  std::string operator()(select::At s) const { return to_string(s.time); }
  std::string operator()(select::Ahead s) const { return "+" + to_string(s.offset); }
  std::string operator()(select::Nearest s) const {
    const std::string text = "nearest:" + to_string(s.time);
    return s.tolerance == Duration::max() ? text : text + "~" + to_string(s.tolerance);
  }
  std::string operator()(select::Before s) const {
    return (s.is_inclusive ? "at-or-before:" : "before:") + to_string(s.time);
  }
  std::string operator()(select::After s) const { return "after:" + to_string(s.time); }
  std::string operator()(select::TimeRange s) const {
    return to_string(s.first) + ".." + to_string(s.last);
  }
  std::string operator()(select::LastDuration s) const { return "last:" + to_string(s.duration); }
  std::string operator()(select::IndexRange s) const {
    return fmt::format("index:{}..{}", s.first, s.last);
  }
};

}  // namespace

Result<NamePattern> NamePattern::parse(std::string_view text) {
  if (text.empty()) return invalid_argument("a name pattern is empty: needs a name or '.*'");
  NamePattern pattern;
  pattern.text_ = text;
  if (text.find_first_of(kRegexCharacters) != std::string_view::npos) {
    const re2::RE2 expression(pattern.text_, re2::RE2::Quiet);
    if (!expression.ok())
      return invalid_argument("name pattern '{}' is no regular expression: {}", text,
                              expression.error());
  }
  return pattern;
}

bool NamePattern::matches(std::string_view name) const {
  if (text_ == ".*" || text_ == name) return true;
  if (text_.find_first_of(kRegexCharacters) == std::string::npos) return false;
  return re2::RE2::FullMatch(re2::StringPiece(name.data(), name.size()),
                             re2::RE2(text_, re2::RE2::Quiet));
}

Result<Query> Query::parse(std::string_view text) {
  const auto in_query = [text](const Status& status) {
    return status.with_context(fmt::format("query '{}'", text));
  };
  const size_t at = text.find(" @");
  const std::string_view names = trim(text.substr(0, at));
  Query query;
  if (!names.empty()) {
    const std::vector<std::string> levels = split_levels(names);
    if (levels.size() > MemoryId::kNameLevels)
      return in_query(
          invalid_argument("has {} name levels, at most 4 are known; the time goes "
                           "behind '@'",
                           levels.size()));
    for (size_t i = 0; i < levels.size(); ++i) {
      auto pattern = NamePattern::parse(levels[i]);
      if (!pattern.ok()) return in_query(pattern.status());
      query.names_[i] = *std::move(pattern);
    }
  }
  if (at != std::string_view::npos) {
    auto selector = parse_selector(trim(text.substr(at + 2)));
    if (!selector.ok()) return in_query(selector.status());
    query.selector_ = *selector;
  }
  return query;
}

Query Query::of_entity(const MemoryId& entity, Selector selector) {
  std::array<NamePattern, MemoryId::kNameLevels> names;
  for (size_t i = 0; i < names.size() && i < entity.names().size(); ++i) {
    auto pattern = NamePattern::parse(re2::RE2::QuoteMeta(entity.names()[i]));
    ENGRAM_CHECK(pattern.ok(), "{}", pattern.status().message());
    names[i] = *std::move(pattern);
  }
  return Query(std::move(names), selector);
}

bool Query::matches(const MemoryId& entity) const {
  for (size_t i = 0; i < names_.size() && i < entity.names().size(); ++i)
    if (!names_[i].matches(entity.names()[i])) return false;
  return true;
}

std::string Query::to_string() const {
  std::string text = names_[0].text();
  for (size_t i = 1; i < names_.size(); ++i) text += "/" + names_[i].text();
  return text + " @ " + std::visit(SelectorPrinter{}, selector_);
}

}  // namespace engram::ltm
