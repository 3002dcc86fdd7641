// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/selector.h"

#include <charconv>
#include <optional>

namespace engram::ltm {

namespace {

/// Integers of times are nanoseconds. One below this limit lies within a second of 1970, which no
/// robot records, so it is an index.
constexpr int64_t kIndexLimit = 1'000'000'000;

std::string_view trim(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
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

struct Validating {
  Status operator()(const select::Latest& s) const {
    if (s.count > 0) return {};
    return invalid_argument("'latest:{}': needs a number above zero", s.count);
  }
  Status operator()(const select::Nearest& s) const {
    if (s.tolerance >= Duration(0)) return {};
    return invalid_argument("tolerance '{}' is negative", engram::to_string(s.tolerance));
  }
  Status operator()(const select::TimeRange& s) const {
    if (s.first <= s.last) return {};
    return invalid_argument("time range '{}..{}' ends before it starts", engram::to_string(s.first),
                            engram::to_string(s.last));
  }
  Status operator()(const select::LastDuration& s) const {
    if (s.duration >= Duration(0)) return {};
    return invalid_argument("'last:{}': needs a positive duration", engram::to_string(s.duration));
  }
  template <typename T>
  Status operator()(const T&) const {
    return {};
  }
};

Result<Selector> parse_index_range(std::string_view text) {
  const size_t dots = text.find("..");
  if (dots != std::string_view::npos) {
    const auto first = parse_integer(trim(text.substr(0, dots)));
    const auto last = parse_integer(trim(text.substr(dots + 2)));
    if (first && last) return Selector(select::IndexRange{*first, *last});
  }
  return invalid_argument("'{}' is no index range: needs 'FIRST..LAST', as in '-3..-1'", text);
}

Result<Selector> parse_time_range(std::string_view text, size_t dots) {
  ENGRAM_ASSIGN_OR_RETURN(const Time from, parse_time(trim(text.substr(0, dots))));
  ENGRAM_ASSIGN_OR_RETURN(const Time to, parse_time(trim(text.substr(dots + 2))));
  return Selector(select::TimeRange{from, to});
}

/// Reads a range. Two integers are indices where both are too small to be times.
Result<Selector> parse_range(std::string_view text, size_t dots) {
  const auto first = parse_integer(trim(text.substr(0, dots)));
  const auto last = parse_integer(trim(text.substr(dots + 2)));
  const auto is_index = [](std::optional<int64_t> value) {
    return value && *value > -kIndexLimit && *value < kIndexLimit;
  };
  if (is_index(first) && is_index(last)) return Selector(select::IndexRange{*first, *last});
  return parse_time_range(text, dots);
}

Result<Selector> parse_nearest(std::string_view text) {
  const size_t tilde = text.find('~');
  ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(trim(text.substr(0, tilde))));
  if (tilde == std::string_view::npos) return Selector(select::Nearest{.time = time});
  ENGRAM_ASSIGN_OR_RETURN(const Duration tolerance, parse_duration(trim(text.substr(tilde + 1))));
  return Selector(select::Nearest{time, tolerance});
}

Result<Selector> parse_latest(std::string_view text) {
  const auto count = parse_integer(text);
  if (count) return Selector(select::Latest{*count});
  return invalid_argument("'latest:{}': needs a number above zero", text);
}

Result<Selector> parse_last(std::string_view text) {
  ENGRAM_ASSIGN_OR_RETURN(const Duration duration, parse_duration(text));
  return Selector(select::LastDuration{duration});
}

/// Reads a selector of a keyword and a time, or of a time alone.
Result<Selector> parse_moment(std::string_view text) {
  const bool is_inclusive = take_prefix(text, "at-or-before:");
  const bool is_before = is_inclusive || take_prefix(text, "before:");
  const bool is_after = !is_before && take_prefix(text, "after:");
  if (!is_before && !is_after) take_prefix(text, "time:");
  ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(trim(text)));
  if (is_before) return Selector(select::Before{time, is_inclusive});
  if (is_after) return Selector(select::After{time});
  return Selector(select::At{time});
}

Result<Selector> parse_any(std::string_view text) {
  if (text.empty())
    return invalid_argument("'' is no selector: needs one, as 'latest', 'all' or a time");
  if (text == "all") return Selector(select::All{});
  if (text == "latest") return Selector(select::Latest{});
  if (take_prefix(text, "latest:")) return parse_latest(text);
  if (take_prefix(text, "last:")) return parse_last(text);
  if (take_prefix(text, "nearest:")) return parse_nearest(text);
  if (take_prefix(text, "index:")) return parse_index_range(text);
  if (take_prefix(text, "until:")) {
    ENGRAM_ASSIGN_OR_RETURN(const Time last, parse_time(trim(text)));
    return Selector(select::TimeRange{Time::min(), last});
  }
  if (text.starts_with('+')) {
    ENGRAM_ASSIGN_OR_RETURN(const Duration offset, parse_duration(text));
    return Selector(select::Ahead{offset});
  }
  const size_t dots = text.find("..");
  if (dots == std::string_view::npos) return parse_moment(text);
  if (take_prefix(text, "time:")) return parse_time_range(text, dots - 5);
  return parse_range(text, dots);
}

struct Printing {
  std::string operator()(const select::All&) const { return "all"; }
  std::string operator()(const select::Latest& s) const {
    return s.count == 1 ? "latest" : fmt::format("latest:{}", s.count);
  }
  std::string operator()(const select::At& s) const { return engram::to_string(s.time); }
  std::string operator()(const select::Ahead& s) const { return "+" + engram::to_string(s.offset); }
  std::string operator()(const select::Nearest& s) const {
    const std::string text = "nearest:" + engram::to_string(s.time);
    return s.tolerance == Duration::max() ? text : text + "~" + engram::to_string(s.tolerance);
  }
  std::string operator()(const select::Before& s) const {
    return (s.is_inclusive ? "at-or-before:" : "before:") + engram::to_string(s.time);
  }
  std::string operator()(const select::After& s) const {
    return "after:" + engram::to_string(s.time);
  }
  std::string operator()(const select::TimeRange& s) const {
    if (s.first == Time::min()) return "until:" + engram::to_string(s.last);
    return engram::to_string(s.first) + ".." + engram::to_string(s.last);
  }
  std::string operator()(const select::LastDuration& s) const {
    return "last:" + engram::to_string(s.duration);
  }
  std::string operator()(const select::IndexRange& s) const {
    return fmt::format("index:{}..{}", s.first, s.last);
  }
};

}  // namespace

Status validate(const Selector& selector) {
  return std::visit(Validating{}, selector);
}

Result<Selector> parse_selector(std::string_view text) {
  ENGRAM_ASSIGN_OR_RETURN(Selector selector, parse_any(trim(text)));
  ENGRAM_RETURN_IF_ERROR(validate(selector));
  return selector;
}

std::string to_string(const Selector& selector) {
  return std::visit(Printing{}, selector);
}

}  // namespace engram::ltm
