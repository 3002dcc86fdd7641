// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/snapshot_condition.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace engram::ltm {

namespace {

using Sighting = where::InView::Sighting;

constexpr std::string_view kNot = "not";
constexpr std::array<std::string_view, 8> kConditionWords = {
    "within", "near", "in-view", "seen-with", "in-vain", "while", "linked-to", "links-from"};

constexpr std::string_view kKnownConditions =
    "'within ENTITY 0.3m', 'near X,Y,Z 0.3m', 'in-view', 'seen-with', 'in-vain' or 'while' and an "
    "ENTITY, or 'linked-to' or 'links-from' and an ID";

bool is_condition_word(std::string_view token) {
  return token == kNot || std::ranges::find(kConditionWords, token) != kConditionWords.end();
}

/// Splits at spaces without a backslash before them.
std::vector<std::string_view> split_tokens(std::string_view text) {
  std::vector<std::string_view> tokens;
  size_t start = 0;
  for (size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && text[i] == '\\') {
      ++i;
    } else if (i >= text.size() || text[i] == ' ') {
      const size_t end = std::min(i, text.size());
      if (end > start) tokens.push_back(text.substr(start, end - start));
      start = i + 1;
    }
  }
  if (start < text.size()) tokens.push_back(text.substr(start));
  return tokens;
}

/// Removes the backslashes that belong to the query; those of names stay for MemoryId::parse.
std::string unescaped(std::string_view text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      const char next = text[i + 1];
      if (next != ' ' && next != ',' && next != ';') plain += '\\';
      plain += next;
      ++i;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

std::string escaped(std::string_view names) {
  std::string text;
  for (const char c : names) {
    if (c == ' ' || c == ',' || c == ';') text += '\\';
    text += c;
  }
  return text;
}

/// Frames are plain texts, which have no backslashes of their own to keep.
std::string unescaped_frame(std::string_view text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) ++i;
    plain += text[i];
  }
  return plain;
}

std::string escaped_frame(std::string_view frame) {
  std::string text(is_condition_word(frame) ? "\\" : "");
  for (const char c : frame) {
    if (c == ' ' || c == ',' || c == ';' || c == '\\') text += '\\';
    text += c;
  }
  return text;
}

/// The time keeps its space, as IDs are printed everywhere.
std::string printed(const MemoryId& id) {
  const std::string names = (id.has_entity() ? id.entity() : id).to_string();
  return escaped(names) + id.to_string().substr(names.size());
}

std::optional<double> parse_double(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Returns metres.
Result<double> parse_length(std::string_view text) {
  struct Unit {
    std::string_view name;
    double divisor;
  };
  // Longer names first. A division rounds once, so that 30cm is the double that 0.3m is.
  static constexpr std::array<Unit, 4> kUnits = {
      {{"mm", 1e3}, {"cm", 1e2}, {"km", 1e-3}, {"m", 1}}};
  for (const Unit& unit : kUnits) {
    if (!text.ends_with(unit.name)) continue;
    if (const auto number = parse_double(text.substr(0, text.size() - unit.name.size())))
      return *number / unit.divisor;
    break;
  }
  return invalid_argument("'{}' is no length: needs a number and mm, cm, m or km, as in '0.3m'",
                          text);
}

Result<std::array<double, 3>> parse_point(std::string_view text) {
  std::array<double, 3> point{};
  std::string_view rest = text;
  for (size_t i = 0; i < point.size(); ++i) {
    const size_t comma = rest.find(',');
    const auto number = (comma == std::string_view::npos) == (i + 1 == point.size())
                            ? parse_double(rest.substr(0, comma))
                            : std::nullopt;
    if (!number)
      return invalid_argument("'{}' is no point: needs three numbers in metres, as in '1,2.5,0.9'",
                              text);
    point[i] = *number;
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  return point;
}

Result<MemoryId> parse_id(std::string_view text) {
  return MemoryId::parse(unescaped(text));
}

/// The text from one token to another one, both included.
std::string_view text_of(std::span<const std::string_view> tokens) {
  if (tokens.empty()) return {};
  return {tokens.front().data(),
          static_cast<size_t>(tokens.back().data() + tokens.back().size() - tokens.front().data())};
}

Result<Condition::Kind> parse_within(std::span<const std::string_view> arguments) {
  if (arguments.size() < 2)
    return invalid_argument("'within {}': needs an entity and a length, as in 'within ENTITY 0.3m'",
                            text_of(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const double metres, parse_length(arguments.back()));
  ENGRAM_ASSIGN_OR_RETURN(MemoryId entity,
                          parse_id(text_of(arguments.first(arguments.size() - 1))));
  return Condition::Kind(where::Within{std::move(entity), metres});
}

Result<Condition::Kind> parse_near(std::span<const std::string_view> arguments) {
  where::Near near;
  if (arguments.size() >= 2 && arguments[arguments.size() - 2] == "in") {
    near.frame = unescaped_frame(arguments.back());
    arguments = arguments.first(arguments.size() - 2);
  }
  if (arguments.size() < 2)
    return invalid_argument("'near {}': needs a point and a length, as in 'near 1,2.5,0.9 0.3m'",
                            text_of(arguments));
  ENGRAM_ASSIGN_OR_RETURN(near.metres, parse_length(arguments.back()));
  // There may be spaces after the commas of the point.
  std::string point(text_of(arguments.first(arguments.size() - 1)));
  std::erase(point, ' ');
  ENGRAM_ASSIGN_OR_RETURN(near.point, parse_point(point));
  return Condition::Kind(std::move(near));
}

Result<Condition::Kind> parse_kind(std::string_view word,
                                   std::span<const std::string_view> arguments) {
  if (word == "within") return parse_within(arguments);
  if (word == "near") return parse_near(arguments);
  if (arguments.empty())
    return invalid_argument("'{}': needs {}", word,
                            word.starts_with("link") ? "an ID" : "an entity");
  ENGRAM_ASSIGN_OR_RETURN(MemoryId id, parse_id(text_of(arguments)));
  if (word == "in-view") return Condition::Kind(where::InView{std::move(id), Sighting::kAny});
  if (word == "seen-with") return Condition::Kind(where::InView{std::move(id), Sighting::kSeen});
  if (word == "in-vain") return Condition::Kind(where::InView{std::move(id), Sighting::kInVain});
  if (word == "while") return Condition::Kind(where::While{std::move(id)});
  if (word == "linked-to") return Condition::Kind(where::LinkedTo{std::move(id)});
  return Condition::Kind(where::LinksFrom{std::move(id)});
}

Status check_length(double metres) {
  if (std::isfinite(metres) && metres >= 0) return {};
  return invalid_argument("'{}m' is no distance: needs a number from 0 on", metres);
}

Status check_entity(const MemoryId& id) {
  if (id.is_entity()) return {};
  return invalid_argument("'{}' is no entity: needs memory/core/provider/entity, without a time",
                          id.to_string());
}

struct ValidatingCondition {
  Status operator()(const where::Within& c) const {
    ENGRAM_RETURN_IF_ERROR(check_length(c.metres));
    return check_entity(c.entity);
  }
  Status operator()(const where::Near& c) const {
    ENGRAM_RETURN_IF_ERROR(check_length(c.metres));
    if (!std::ranges::all_of(c.point, [](double x) { return std::isfinite(x); }))
      return invalid_argument("'{},{},{}' is no point: needs finite numbers", c.point[0],
                              c.point[1], c.point[2]);
    if (c.frame.empty()) return invalid_argument("'near': needs a frame, as in 'in world'");
    return {};
  }
  Status operator()(const where::InView& c) const { return check_entity(c.entity); }
  Status operator()(const where::While& c) const { return check_entity(c.entity); }
  Status operator()(const where::LinkedTo& c) const { return check_id(c.id); }
  Status operator()(const where::LinksFrom& c) const { return check_id(c.id); }

 private:
  static Status check_id(const MemoryId& id) {
    if (id.has_entity()) return {};
    return invalid_argument("'{}' is no ID of an entity, a snapshot or an instance",
                            id.to_string());
  }
};

struct PrintingCondition {
  std::string operator()(const where::Within& c) const {
    return fmt::format("within {} {}m", printed(c.entity), c.metres);
  }
  std::string operator()(const where::Near& c) const {
    const std::string text =
        fmt::format("near {},{},{} {}m", c.point[0], c.point[1], c.point[2], c.metres);
    return c.frame == where::Near().frame ? text : text + " in " + escaped_frame(c.frame);
  }
  std::string operator()(const where::InView& c) const {
    const char* const word = c.sighting == Sighting::kAny    ? "in-view "
                             : c.sighting == Sighting::kSeen ? "seen-with "
                                                             : "in-vain ";
    return word + printed(c.entity);
  }
  std::string operator()(const where::While& c) const { return "while " + printed(c.entity); }
  std::string operator()(const where::LinkedTo& c) const { return "linked-to " + printed(c.id); }
  std::string operator()(const where::LinksFrom& c) const { return "links-from " + printed(c.id); }
};

}  // namespace

std::optional<MemoryId> entity_of(const Condition& condition) {
  if (const auto* within = std::get_if<where::Within>(&condition.kind)) return within->entity;
  if (const auto* view = std::get_if<where::InView>(&condition.kind)) return view->entity;
  if (const auto* during = std::get_if<where::While>(&condition.kind)) return during->entity;
  if (const auto* from = std::get_if<where::LinksFrom>(&condition.kind)) return from->id.entity();
  return std::nullopt;
}

Status validate(const Condition& condition) {
  return std::visit(ValidatingCondition{}, condition.kind);
}

Result<std::vector<Condition>> parse_conditions(std::string_view text) {
  std::vector<Condition> conditions;
  const std::vector<std::string_view> all = split_tokens(text);
  std::span<const std::string_view> tokens = all;
  while (!tokens.empty()) {
    Condition condition;
    condition.is_negated = tokens.front() == kNot;
    if (condition.is_negated) tokens = tokens.subspan(1);
    if (tokens.empty() || tokens.front() == kNot || !is_condition_word(tokens.front()))
      return invalid_argument("'{}' is no condition: needs {}",
                              tokens.empty() ? std::string_view() : tokens.front(),
                              kKnownConditions);
    const std::string_view word = tokens.front();
    tokens = tokens.subspan(1);
    const auto end = std::ranges::find_if(tokens, is_condition_word);
    const auto arguments = tokens.first(static_cast<size_t>(end - tokens.begin()));
    ENGRAM_ASSIGN_OR_RETURN(condition.kind, parse_kind(word, arguments));
    ENGRAM_RETURN_IF_ERROR(validate(condition));
    tokens = tokens.subspan(arguments.size());
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

size_t find_conditions(std::string_view text) {
  for (const std::string_view token : split_tokens(text))
    if (is_condition_word(token)) return static_cast<size_t>(token.data() - text.data());
  return std::string_view::npos;
}

bool ends_in_a_point(std::string_view text) {
  const std::vector<std::string_view> tokens = split_tokens(text);
  for (auto token = tokens.rbegin(); token != tokens.rend(); ++token) {
    if (!is_condition_word(*token)) continue;
    const char* const behind = token->data() + token->size();
    return *token == "near" && std::count(behind, text.data() + text.size(), ',') < 2;
  }
  return false;
}

std::string to_string(const Condition& condition) {
  return (condition.is_negated ? "not " : "") + std::visit(PrintingCondition{}, condition.kind);
}

}  // namespace engram::ltm
