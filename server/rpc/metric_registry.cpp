// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/metric_registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "ltm/core/check.h"
#include "ltm/core/utf8.h"

namespace engram::server {

namespace {

constexpr std::string_view kOther = "other";
/// The suffixes that a histogram appends to its name.
constexpr std::array<std::string_view, 3> kHistogramSuffixes{"_bucket", "_sum", "_count"};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_label_name(std::string_view name) {
  return !name.empty() && is_letter(name.front()) && !name.starts_with("__") &&
         std::ranges::all_of(name, [](char c) { return is_letter(c) || is_digit(c); });
}

bool is_metric_name(std::string_view name) {
  const auto is_first = [](char c) { return is_letter(c) || c == ':'; };
  return !name.empty() && is_first(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_first(c) || is_digit(c); });
}

void check_info(const MetricInfo& info) {
  ENGRAM_CHECK(is_metric_name(info.name), "'{}' is no name of a metric", info.name);
  ENGRAM_CHECK(is_utf8(info.help), "help of '{}' is no UTF-8", info.name);
  std::set<std::string_view> seen;
  for (const std::string& label : info.labels) {
    ENGRAM_CHECK(is_label_name(label), "'{}' is no name of a label of '{}'", label, info.name);
    ENGRAM_CHECK(seen.insert(label).second, "'{}' has the label '{}' twice", info.name, label);
  }
}

std::string bounded_value(std::string value, size_t max_bytes) {
  value.resize(cut_utf8(value, max_bytes).size());
  if (!is_utf8(value))
    std::ranges::replace_if(
        value, [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
  return value;
}

/// Escapes backslashes, line breaks and, in label values, quotes.
std::string escaped(std::string_view text, bool is_value) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\\\";
    else if (c == '\n')
      out += "\\n";
    else if (c == '"' && is_value)
      out += "\\\"";
    else
      out += c;
  }
  return out;
}

std::string number_text(double number) {
  // Prometheus prescribes these spellings; fmt would write "nan" and "inf".
  if (std::isnan(number)) return "NaN";
  if (std::isinf(number)) return number > 0 ? "+Inf" : "-Inf";
  return fmt::format("{}", number);
}

/// Writes the text lines of one family.
class FamilyText {
 public:
  FamilyText(const MetricInfo& info, std::string_view kind, std::string& out)
      : info_(info), out_(out) {
    out_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", info.name, escaped(info.help, false),
                        info.name, kind);
  }

  /// Writes one line. `bound` is the value of the label `le`; an empty one omits the label.
  void add(const std::vector<std::string>& values, std::string_view number,
           std::string_view suffix = "", std::string_view bound = "") {
    out_ += info_.name;
    out_ += suffix;
    char separator = '{';
    const auto label = [&](std::string_view name, std::string_view value) {
      out_ += fmt::format("{}{}=\"{}\"", separator, name, escaped(value, true));
      separator = ',';
    };
    for (size_t i = 0; i < values.size(); ++i) label(info_.labels[i], values[i]);
    if (!bound.empty()) label("le", bound);
    if (separator == ',') out_ += '}';
    out_ += fmt::format(" {}\n", number);
  }

 private:
  const MetricInfo& info_;
  std::string& out_;
};

void write(const MetricFamily<Counter>& family, std::string& out) {
  FamilyText text(family.info(), "counter", out);
  family.for_each([&](const auto& values, const Counter& counter) {
    text.add(values, std::to_string(counter.value()));
  });
}

void write(const MetricFamily<Gauge>& family, std::string& out) {
  FamilyText text(family.info(), "gauge", out);
  family.for_each([&](const auto& values, const Gauge& gauge) {
    text.add(values, number_text(gauge.value()));
  });
}

void write(const MetricFamily<Histogram>& family, std::string& out) {
  FamilyText text(family.info(), "histogram", out);
  family.for_each([&](const auto& values, const Histogram& histogram) {
    const std::vector<uint64_t> counts = histogram.cumulative_counts();
    const std::vector<double>& bounds = histogram.bounds();
    for (size_t i = 0; i < counts.size(); ++i)
      text.add(values, std::to_string(counts[i]), "_bucket",
               i < bounds.size() ? number_text(bounds[i]) : "+Inf");
    text.add(values, number_text(histogram.sum()), "_sum");
    text.add(values, std::to_string(counts.back()), "_count");
  });
}

}  // namespace

template <typename Metric>
Metric& MetricFamily<Metric>::with(std::vector<std::string> values) {
  ENGRAM_CHECK(values.size() == info_.labels.size(), "'{}' has {} labels, found {} values",
               info_.name, info_.labels.size(), values.size());
  for (std::string& value : values) value = bounded_value(std::move(value), kMaxValueBytes);
  {
    const SharedLock lock(mutex_);
    const auto found = series_.find(values);
    if (found != series_.end()) return *found->second;
  }
  const ExclusiveLock lock(mutex_);
  if (series_.size() >= kMaxSeries && !series_.contains(values))
    values.assign(values.size(), std::string(kOther));
  auto& metric = series_[std::move(values)];
  if (metric == nullptr) metric = make_();
  return *metric;
}

template class MetricFamily<Counter>;
template class MetricFamily<Gauge>;
template class MetricFamily<Histogram>;

MetricRegistry::Family& MetricRegistry::family(const MetricInfo& info) {
  check_info(info);
  Family& family = families_[info.name];
  const MetricInfo* found = family.counters     ? &family.counters->info()
                            : family.gauges     ? &family.gauges->info()
                            : family.histograms ? &family.histograms->info()
                                                : nullptr;
  ENGRAM_CHECK(found == nullptr || *found == info, "'{}' is registered as something else",
               info.name);
  for (const std::string_view suffix : kHistogramSuffixes) {
    if (!info.name.ends_with(suffix)) continue;
    const auto base = families_.find(info.name.substr(0, info.name.size() - suffix.size()));
    ENGRAM_CHECK(base == families_.end() || !base->second.histograms,
                 "'{}' is a line of the histogram '{}'", info.name, base->first);
  }
  return family;
}

MetricFamily<Counter>& MetricRegistry::counters(MetricInfo info) {
  const MutexLock lock(mutex_);
  Family& one = family(info);
  ENGRAM_CHECK(!one.gauges && !one.histograms, "'{}' is no counter", info.name);
  if (!one.counters)
    one.counters = std::make_unique<MetricFamily<Counter>>(
        std::move(info), [] { return std::make_unique<Counter>(); });
  return *one.counters;
}

MetricFamily<Gauge>& MetricRegistry::gauges(MetricInfo info) {
  const MutexLock lock(mutex_);
  Family& one = family(info);
  ENGRAM_CHECK(!one.counters && !one.histograms, "'{}' is no gauge", info.name);
  if (!one.gauges)
    one.gauges = std::make_unique<MetricFamily<Gauge>>(std::move(info),
                                                       [] { return std::make_unique<Gauge>(); });
  return *one.gauges;
}

MetricFamily<Histogram>& MetricRegistry::histograms(MetricInfo info,
                                                    const std::vector<double>& bounds) {
  const MutexLock lock(mutex_);
  Family& one = family(info);
  ENGRAM_CHECK(!one.counters && !one.gauges, "'{}' is no histogram", info.name);
  ENGRAM_CHECK(std::ranges::find(info.labels, "le") == info.labels.end(),
               "'{}' has the label 'le', which histograms have themselves", info.name);
  ENGRAM_CHECK(!one.histograms || one.bounds == bounds, "'{}' has other bounds", info.name);
  for (const std::string_view suffix : kHistogramSuffixes)
    ENGRAM_CHECK(!families_.contains(fmt::format("{}{}", info.name, suffix)),
                 "'{}{}', a line of this histogram, is registered", info.name, suffix);
  if (!one.histograms) {
    one.bounds = bounds;
    one.histograms = std::make_unique<MetricFamily<Histogram>>(
        std::move(info), [bounds] { return std::make_unique<Histogram>(bounds); });
  }
  return *one.histograms;
}

Counter& MetricRegistry::counter(std::string name, std::string help) {
  return counters({std::move(name), std::move(help), {}}).with({});
}

Gauge& MetricRegistry::gauge(std::string name, std::string help) {
  return gauges({std::move(name), std::move(help), {}}).with({});
}

Histogram& MetricRegistry::histogram(std::string name, std::string help,
                                     const std::vector<double>& bounds) {
  return histograms({std::move(name), std::move(help), {}}, bounds).with({});
}

std::string MetricRegistry::to_text() const {
  std::string text;
  const MutexLock lock(mutex_);
  for (const auto& [name, family] : families_) {
    if (family.counters) write(*family.counters, text);
    if (family.gauges) write(*family.gauges, text);
    if (family.histograms) write(*family.histograms, text);
  }
  return text;
}

}  // namespace engram::server
