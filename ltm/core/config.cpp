// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/config.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "ltm/core/config_tree.h"

namespace engram {

namespace {

/// The bound of a text that an error quotes.
constexpr size_t kMaxQuoted = 80;

/// The number at the start of a text, and the rest.
struct NumberWithUnit {
  double number = 0;
  std::string_view unit;
};

std::optional<NumberWithUnit> take_number(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  return NumberWithUnit{number, text.substr(static_cast<size_t>(end - text.data()))};
}

struct NumberUnit {
  std::string_view name;
  double factor;
};

template <size_t N>
std::optional<double> in_units(std::string_view text, const std::array<NumberUnit, N>& units) {
  const auto parts = take_number(text);
  if (!parts) return std::nullopt;
  for (const NumberUnit& unit : units)
    if (unit.name == parts->unit) return parts->number * unit.factor;
  return std::nullopt;
}

std::string child_key(const std::string& above, std::string_view key) {
  return above.empty() ? std::string(key) : fmt::format("{}.{}", above, key);
}

}  // namespace

bool ConfigValue::is_text() const {
  return node_->kind == Node::Kind::kText;
}
bool ConfigValue::is_list() const {
  return node_->kind == Node::Kind::kList;
}
bool ConfigValue::is_map() const {
  return node_->kind == Node::Kind::kMap;
}
bool ConfigValue::is_quoted() const {
  return node_->is_quoted;
}

Result<ConfigValue> ConfigValue::read_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, read_config_text(path));
  return parse(text, path.string());
}

std::string ConfigValue::found() const {
  switch (node_->kind) {
    case Node::Kind::kNull:
      return "nothing";
    case Node::Kind::kList:
      return "a list";
    case Node::Kind::kMap:
      return "a map";
    case Node::Kind::kText:
      break;
  }
  return node_->text.size() > kMaxQuoted ? fmt::format("'{}...'", node_->text.substr(0, kMaxQuoted))
                                         : fmt::format("'{}'", node_->text);
}

Status ConfigValue::error(std::string_view message) const {
  return invalid_argument("{}:{}: {}{}", root_->name, node_->line,
                          key_.empty() ? "" : fmt::format("'{}': ", key_), message);
}

Status ConfigValue::error(const Status& status) const {
  return error(status.message());
}

Status ConfigValue::needs(std::string_view what) const {
  return error(fmt::format("found {}, needs {}", found(), what));
}

Result<std::string> ConfigValue::text() const {
  if (!is_text()) return needs("a text");
  return node_->text;
}

Result<bool> ConfigValue::boolean() const {
  if (is_text() && !node_->is_quoted && (node_->text == "true" || node_->text == "false"))
    return node_->text == "true";
  return needs("true or false");
}

Result<double> ConfigValue::number() const {
  const auto parts = is_text() ? take_number(node_->text) : std::nullopt;
  if (!parts || !parts->unit.empty()) return needs("a number");
  return parts->number;
}

Result<int64_t> ConfigValue::integer() const {
  int64_t value = 0;
  const char* end = node_->text.data() + node_->text.size();
  const auto [at, error] = std::from_chars(node_->text.data(), end, value);
  if (!is_text() || error != std::errc() || at != end) return needs("a whole number");
  return value;
}

Result<Duration> ConfigValue::duration() const {
  if (is_text()) {
    const auto value = parse_duration(node_->text);
    if (value.ok() && *value >= Duration(0)) return *value;
  }
  return needs("a duration, as in 200ms, 10s or 5min");
}

Result<Duration> ConfigValue::duration_or_never() const {
  if (is_text() && *text() == "never") return Duration::max();
  const auto found = duration();
  return found.ok() ? found : found.status().with_context("(or 'never')");
}

Result<uint64_t> ConfigValue::bytes() const {
  static constexpr std::array<NumberUnit, 9> kUnits{{{"B", 1},
                                                     {"kB", 1e3},
                                                     {"MB", 1e6},
                                                     {"GB", 1e9},
                                                     {"TB", 1e12},
                                                     {"KiB", 1024.0},
                                                     {"MiB", 1048576.0},
                                                     {"GiB", 1073741824.0},
                                                     {"TiB", 1099511627776.0}}};
  const auto value = is_text() ? in_units(node_->text, kUnits) : std::nullopt;
  if (!value || *value < 0 || *value > 1e18)
    return needs("a size with its unit, as in 64MiB or 500MB");
  return static_cast<uint64_t>(*value);
}

Result<double> ConfigValue::rate_hz() const {
  static constexpr std::array<NumberUnit, 3> kUnits{{{"Hz", 1}, {"kHz", 1e3}, {"mHz", 1e-3}}};
  const auto value = is_text() ? in_units(node_->text, kUnits) : std::nullopt;
  if (!value || *value <= 0) return needs("a rate with its unit, as in 5Hz");
  return *value;
}

Result<std::vector<ConfigValue>> ConfigValue::list() const {
  if (!is_list()) return needs("a list");
  std::vector<ConfigValue> values;
  for (size_t i = 0; i < node_->entries.size(); ++i)
    values.push_back(ConfigValue(root_, &node_->entries[i].value, fmt::format("{}[{}]", key_, i)));
  return values;
}

Result<ConfigMap> ConfigValue::map() const {
  if (!is_map()) return needs("a map of keys");
  return ConfigMap(*this);
}

std::optional<ConfigValue> ConfigMap::find(std::string_view key) {
  known_.emplace(key);
  for (const auto& entry : value_.node_->entries)
    if (entry.key == key && entry.value.kind != ConfigValue::Node::Kind::kNull)
      return ConfigValue(value_.root_, &entry.value, child_key(value_.key_, key));
  return std::nullopt;
}

Result<std::optional<ConfigValue>> ConfigMap::find(const DeprecatedWord& word) {
  const std::optional<ConfigValue> value = find(word.word);
  // Looks for the old word only if the file has it: otherwise errors would suggest it as a known
  // key.
  const std::vector<std::string> there = keys();
  if (std::ranges::find(there, word.old_word) == there.end()) return value;
  const std::optional<ConfigValue> old = find(word.old_word);
  if (value && old) return old->error(fmt::format("stands beside '{}', its new name", word.word));
  warn_deprecated(word, child_key(value_.key_, word.old_word));
  return value ? value : old;
}

Result<ConfigValue> ConfigMap::require(std::string_view key) {
  if (auto value = find(key)) return *std::move(value);
  return value_.error(fmt::format("has no key '{}', needs one", key));
}

Status ConfigMap::finish() const {
  for (const auto& entry : value_.node_->entries) {
    if (known_.contains(entry.key)) continue;
    const ConfigValue at(value_.root_, &entry.value, child_key(value_.key_, entry.key));
    const std::vector<std::string> known(known_.begin(), known_.end());
    const auto closest = closest_word(entry.key, known);
    return at.error(closest ? fmt::format("unknown key; did you mean '{}'?", *closest)
                            : fmt::format("unknown key; known are {}", fmt::join(known, ", ")));
  }
  return {};
}

std::vector<std::string> ConfigMap::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : value_.node_->entries) keys.push_back(entry.key);
  return keys;
}

std::optional<std::string> closest_word(std::string_view word,
                                        const std::vector<std::string>& known) {
  constexpr size_t kLongest = 64;
  if (word.size() > kLongest) return std::nullopt;
  // Up to a third of the letters may be wrong, and at least two; but never all of a short word.
  size_t min =
      std::min(std::max<size_t>(2, word.size() / 3), std::max<size_t>(word.size(), 1) - 1) + 1;
  std::optional<std::string> closest;
  for (const std::string& candidate : known) {
    // Rows of the table of edit distances between the prefixes of both words.
    std::vector<size_t> above(candidate.size() + 1);
    for (size_t i = 0; i < above.size(); ++i) above[i] = i;
    for (size_t row = 1; row <= word.size(); ++row) {
      std::vector<size_t> current{row};
      for (size_t i = 1; i <= candidate.size(); ++i)
        current.push_back(std::min({above[i] + 1, current[i - 1] + 1,
                                    above[i - 1] + (word[row - 1] == candidate[i - 1] ? 0 : 1)}));
      above = std::move(current);
    }
    if (above.back() >= min) continue;
    min = above.back();
    closest = candidate;
  }
  return closest;
}

}  // namespace engram
