// SPDX-License-Identifier: Apache-2.0
#include "tests/server/rpc/prometheus_text.h"

#include <cstdlib>
#include <limits>
#include <optional>
#include <regex>
#include <set>

namespace engram::testing {

namespace {

const std::regex kMetricName("[a-zA-Z_:][a-zA-Z0-9_:]*");
const std::regex kLabelName("[a-zA-Z_][a-zA-Z0-9_]*");

/// Reads one line from left to right.
class Line {
 public:
  explicit Line(std::string_view text) : text_(text) {}

  bool take(std::string_view piece) {
    if (!text_.starts_with(piece)) return false;
    text_.remove_prefix(piece.size());
    return true;
  }

  std::string take_until(std::string_view ends) {
    const size_t at = std::min(text_.find_first_of(ends), text_.size());
    const std::string taken(text_.substr(0, at));
    text_.remove_prefix(at);
    return taken;
  }

  /// A text in quotes, or up to the end of the line.
  std::optional<std::string> take_escaped(bool is_quoted) {
    std::string taken;
    while (!text_.empty()) {
      const char c = text_.front();
      text_.remove_prefix(1);
      if (is_quoted && c == '"') return taken;
      if (c != '\\') {
        taken += c;
        continue;
      }
      if (take("n"))
        taken += '\n';
      else if (take("\\"))
        taken += '\\';
      else if (is_quoted && take("\""))
        taken += '"';
      else
        return std::nullopt;
    }
    return is_quoted ? std::nullopt : std::optional(taken);
  }

  [[nodiscard]] bool empty() const { return text_.empty(); }

 private:
  std::string_view text_;
};

std::optional<double> read_number(const std::string& text) {
  if (text == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (text == "+Inf") return std::numeric_limits<double>::infinity();
  if (text == "-Inf") return -std::numeric_limits<double>::infinity();
  if (text.empty() || text.find_first_not_of("0123456789+-.e") != std::string::npos)
    return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end != text.c_str() + text.size()) return std::nullopt;
  return number;
}

std::optional<PrometheusSample> read_sample(Line line) {
  PrometheusSample sample;
  sample.name = line.take_until("{ ");
  if (!std::regex_match(sample.name, kMetricName)) return std::nullopt;
  if (line.take("{")) {
    do {
      const std::string label = line.take_until("=");
      if (!std::regex_match(label, kLabelName) || !line.take("=\"")) return std::nullopt;
      auto value = line.take_escaped(true);
      if (!value || !sample.labels.emplace(label, *value).second) return std::nullopt;
    } while (line.take(","));
    if (!line.take("}")) return std::nullopt;
  }
  if (!line.take(" ")) return std::nullopt;
  const auto number = read_number(line.take_until(" "));
  if (!number || !line.empty()) return std::nullopt;
  sample.number = *number;
  return sample;
}

/// Of each combination of other labels: bounds increase, counts do not fall, all are counted.
bool has_sound_buckets(const std::string& name, const PrometheusFamily& family) {
  struct Seen {
    double bound = -std::numeric_limits<double>::infinity();
    double count = 0;
    bool has_sum = false;
    bool has_count = false;
  };
  std::map<std::map<std::string, std::string>, Seen> all;
  for (const PrometheusSample& sample : family.samples) {
    auto labels = sample.labels;
    labels.erase("le");
    Seen& seen = all[labels];
    if (sample.name == name + "_bucket") {
      const auto bound =
          sample.labels.contains("le") ? read_number(sample.labels.at("le")) : std::nullopt;
      if (!bound || *bound <= seen.bound || sample.number < seen.count) return false;
      seen.bound = *bound;
      seen.count = sample.number;
    } else if (sample.name == name + "_sum") {
      seen.has_sum = true;
    } else if (sample.name == name + "_count") {
      seen.has_count = sample.number == seen.count;
    } else {
      return false;
    }
  }
  for (const auto& [labels, seen] : all)
    if (seen.bound < std::numeric_limits<double>::infinity() || !seen.has_sum || !seen.has_count)
      return false;
  return true;
}

}  // namespace

Result<std::map<std::string, PrometheusFamily>> read_prometheus_text(std::string_view text) {
  std::map<std::string, PrometheusFamily> families;
  std::set<std::pair<std::string, std::map<std::string, std::string>>> seen;
  std::string current;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const std::string_view whole = text.substr(0, end);
    if (end == std::string_view::npos) return invalid_argument("no end: '{}'", whole);
    text.remove_prefix(end + 1);
    Line line(whole);
    if (line.take("# HELP ")) {
      current = line.take_until(" ");
      if (families.contains(current)) return invalid_argument("again: '{}'", whole);
      const auto help = line.take(" ") ? line.take_escaped(false) : std::nullopt;
      if (!help) return invalid_argument("no help: '{}'", whole);
      families[current].help = *help;
      continue;
    }
    PrometheusFamily& family = families[current];
    if (line.take("# TYPE ")) {
      if (!line.take(current + " ") || !family.kind.empty())
        return invalid_argument("no type of '{}': '{}'", current, whole);
      family.kind = line.take_until("");
      if (family.kind != "counter" && family.kind != "gauge" && family.kind != "histogram")
        return invalid_argument("no kind: '{}'", whole);
      continue;
    }
    const auto sample = read_sample(line);
    if (!sample || family.kind.empty()) return invalid_argument("no sample: '{}'", whole);
    if (family.kind != "histogram" && sample->name != current)
      return invalid_argument("not of '{}': '{}'", current, whole);
    if (!seen.emplace(sample->name, sample->labels).second)
      return invalid_argument("again: '{}'", whole);
    family.samples.push_back(*sample);
  }
  for (const auto& [name, family] : families)
    if (family.kind == "histogram" && !has_sound_buckets(name, family))
      return invalid_argument("buckets of '{}' do not add up", name);
  return families;
}

}  // namespace engram::testing
