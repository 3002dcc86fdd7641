// SPDX-License-Identifier: Apache-2.0
#include "viewer/request_target.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "ltm/core/printable.h"
#include "ltm/core/utf8.h"

namespace engram::viewer {

namespace {

std::optional<int> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

Result<std::string> decoded(std::string_view text, bool is_query) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += is_query && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const auto high = i + 2 < text.size() ? hex_digit(text[i + 1]) : std::nullopt;
    const auto low = high ? hex_digit(text[i + 2]) : std::nullopt;
    if (!low)
      return invalid_argument("target: found '{}', needs '%' and two hexadecimal digits",
                              printable(text.substr(i, 3)));
    out += static_cast<char>(*high * 16 + *low);
    i += 2;
  }
  if (!is_utf8(out) || out.find('\0') != std::string::npos)
    return invalid_argument("target: found bytes that are no text, needs UTF-8");
  return out;
}

Status wrong(std::string_view name, std::string_view found, std::string_view needed) {
  constexpr size_t kShown = 100;
  return invalid_argument("parameter '{}': found '{}', needs {}", name,
                          printable(found.substr(0, kShown)), needed);
}

Status missing(std::string_view name) {
  return invalid_argument("parameter '{}' is missing", name);
}

Result<int64_t> integer_of(std::string_view name, std::string_view text, int64_t min, int64_t max) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < min || value > max)
    return wrong(name, text, fmt::format("an integer from {} to {}", min, max));
  return value;
}

Result<ltm::MemoryId> id_of(std::string_view name, const std::string& text) {
  auto id = ltm::MemoryId::parse(text);
  if (!id.ok()) return id.status().with_context(fmt::format("parameter '{}'", name));
  return id;
}

}  // namespace

Result<RequestTarget> RequestTarget::parse(std::string_view target) {
  if (target.size() > kMaxBytes)
    return invalid_argument("target: has {} bytes, needs at most {}", target.size(), kMaxBytes);
  if (!target.starts_with('/')) return invalid_argument("target: needs to begin with '/'");
  RequestTarget parsed;
  const size_t mark = target.find('?');
  ENGRAM_ASSIGN_OR_RETURN(parsed.path_, decoded(target.substr(0, mark), false));
  std::string_view rest = mark == std::string_view::npos ? "" : target.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), one.size() + 1));
    if (one.empty()) continue;
    if (parsed.parameters_.size() == kMaxParameters)
      return invalid_argument("target: has more than {} parameters", kMaxParameters);
    const size_t equals = one.find('=');
    Parameter parameter{std::string(one), {}, {}};
    ENGRAM_ASSIGN_OR_RETURN(parameter.name, decoded(one.substr(0, equals), true));
    if (equals != std::string_view::npos) {
      ENGRAM_ASSIGN_OR_RETURN(parameter.value, decoded(one.substr(equals + 1), true));
    }
    parsed.parameters_.push_back(std::move(parameter));
  }
  return parsed;
}

std::optional<std::string> RequestTarget::find(std::string_view name) const {
  const auto found = std::ranges::find(parameters_, name, &Parameter::name);
  return found == parameters_.end() ? std::nullopt : std::optional(found->value);
}

std::vector<std::string> RequestTarget::all(std::string_view name) const {
  std::vector<std::string> values;
  for (const Parameter& parameter : parameters_)
    if (parameter.name == name) values.push_back(parameter.value);
  return values;
}

std::string RequestTarget::query_without(std::string_view name) const {
  std::string query;
  for (const Parameter& parameter : parameters_)
    if (parameter.name != name) query += (query.empty() ? "?" : "&") + parameter.raw;
  return query;
}

Result<std::string> RequestTarget::text(std::string_view name) const {
  auto found = find(name);
  if (!found || found->empty()) return missing(name);
  return *std::move(found);
}

Result<std::string> RequestTarget::choice(std::string_view name,
                                          const std::vector<std::string>& choices,
                                          const std::string& otherwise) const {
  const auto found = find(name);
  if (!found) return otherwise;
  if (std::ranges::find(choices, *found) != choices.end()) return *found;
  return wrong(name, *found, fmt::format("one of {}", fmt::join(choices, ", ")));
}

Result<int64_t> RequestTarget::integer(std::string_view name, int64_t min, int64_t max) const {
  const auto found = find(name);
  if (!found) return missing(name);
  return integer_of(name, *found, min, max);
}

Result<int64_t> RequestTarget::integer(std::string_view name, int64_t min, int64_t max,
                                       int64_t otherwise) const {
  const auto found = find(name);
  return found ? integer_of(name, *found, min, max) : otherwise;
}

Result<std::vector<int64_t>> RequestTarget::integers(std::string_view name, int64_t min,
                                                     int64_t max, size_t max_count) const {
  ENGRAM_ASSIGN_OR_RETURN(const std::string found, text(name));
  std::vector<int64_t> numbers;
  for (size_t begin = 0; begin <= found.size();) {
    if (numbers.size() == max_count)
      return wrong(name, found, fmt::format("at most {} numbers", max_count));
    const size_t end = std::min(found.find(',', begin), found.size());
    ENGRAM_ASSIGN_OR_RETURN(
        const int64_t number,
        integer_of(name, std::string_view(found).substr(begin, end - begin), min, max));
    numbers.push_back(number);
    begin = end + 1;
  }
  return numbers;
}

Result<double> RequestTarget::number(std::string_view name, double min, double max) const {
  ENGRAM_ASSIGN_OR_RETURN(const std::string found, text(name));
  double number = 0;
  const char* const end = found.data() + found.size();
  const auto [stop, error] = std::from_chars(found.data(), end, number);
  // Written so that "nan" is refused, too.
  if (error != std::errc() || stop != end || !(number >= min && number <= max))
    return wrong(name, found, fmt::format("a number from {} to {}", min, max));
  return number;
}

Result<Time> RequestTarget::time(std::string_view name) const {
  using Limits = std::numeric_limits<int64_t>;
  ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, integer(name, Limits::min(), Limits::max()));
  return time_from_ns(ns);
}

Result<ltm::MemoryId> RequestTarget::entity(std::string_view name) const {
  ENGRAM_ASSIGN_OR_RETURN(const std::string found, text(name));
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, id_of(name, found));
  if (!id.is_entity()) return wrong(name, found, "the ID of an entity");
  return id;
}

Result<std::vector<ltm::MemoryId>> RequestTarget::names(std::string_view name, size_t max) const {
  const std::vector<std::string> texts = all(name);
  if (texts.empty()) return missing(name);
  if (texts.size() > max)
    return invalid_argument("parameter '{}': found it {} times, needs at most {}", name,
                            texts.size(), max);
  std::vector<ltm::MemoryId> ids;
  for (const std::string& text : texts) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, id_of(name, text));
    if (id.depth() == 0 || id.time())
      return wrong(name, text, "the ID of an entity, or of a segment or memory");
    ids.push_back(std::move(id));
  }
  return ids;
}

Result<ltm::MemoryId> RequestTarget::moment(std::string_view name) const {
  ENGRAM_ASSIGN_OR_RETURN(const std::string found, text(name));
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, id_of(name, found));
  if (!id.time()) return wrong(name, found, "the ID of a snapshot or an instance");
  return id;
}

}  // namespace engram::viewer
