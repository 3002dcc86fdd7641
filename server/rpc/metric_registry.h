// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "server/rpc/metrics.h"

namespace engram::server {

/// What all metrics of one name have in common.
struct MetricInfo {
  /// Such as "engram_commits_total"; times are in seconds, sizes in bytes.
  std::string name;
  std::string help;                 ///< One sentence for people.
  std::vector<std::string> labels;  ///< Names of the labels that distinguish the metrics.

  friend bool operator==(const MetricInfo&, const MetricInfo&) = default;
};

/// The metrics of one name: one metric for each combination of label values.
///
/// Look a metric up once and keep the reference, which stays valid as long as the registry:
/// counting then takes no lock.
/// Threading: thread-safe.
template <typename Metric>
class MetricFamily {
 public:
  /// Label values may come from clients, so their number is bounded. Beyond this many combinations,
  /// new ones are counted together, with `other` as the value of every label.
  static constexpr size_t kMaxSeries = 1000;
  /// Longer label values are cut.
  static constexpr size_t kMaxValueBytes = 256;

  using Make = std::function<std::unique_ptr<Metric>()>;
  using Series = std::map<std::vector<std::string>, std::unique_ptr<Metric>>;

  MetricFamily(MetricInfo info, Make make) : info_(std::move(info)), make_(std::move(make)) {}

  /// Returns the metric with these label values and makes it on first use. Needs one value per
  /// label (checked). Bytes that are not UTF-8 become question marks.
  Metric& with(std::vector<std::string> values);

  [[nodiscard]] const MetricInfo& info() const { return info_; }

  /// Calls `visit(values, metric)` for each metric, ordered by label values.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    const SharedLock lock(mutex_);
    for (const auto& [values, metric] : series_) visit(values, *metric);
  }

 private:
  const MetricInfo info_;
  const Make make_;

  mutable SharedMutex mutex_;
  Series series_ ENGRAM_GUARDED_BY(mutex_);
};

extern template class MetricFamily<Counter>;
extern template class MetricFamily<Gauge>;
extern template class MetricFamily<Histogram>;

/// All metrics of a server, with their text for Prometheus (format 0.0.4).
///
/// Debian's prometheus-cpp is not used because it brings an HTTP server of its own (civetweb) into
/// the process; only this text is needed, and any existing endpoint can serve it.
///
/// A name that is requested again returns the same metrics. Requesting it with another kind, help
/// text, labels or bounds is a programming error and aborts, as does a name that Prometheus does
/// not allow.
/// Threading: thread-safe.
class MetricRegistry {
 public:
  MetricFamily<Counter>& counters(MetricInfo info);
  MetricFamily<Gauge>& gauges(MetricInfo info);
  /// `bounds` are those of Histogram. The label `le` is reserved.
  MetricFamily<Histogram>& histograms(MetricInfo info,
                                      const std::vector<double>& bounds = latency_bounds());

  /// Like counters(), gauges() and histograms(), for a metric without labels.
  Counter& counter(std::string name, std::string help);
  Gauge& gauge(std::string name, std::string help);
  Histogram& histogram(std::string name, std::string help,
                       const std::vector<double>& bounds = latency_bounds());

  /// Returns the text that Prometheus reads, ordered by name.
  [[nodiscard]] std::string to_text() const;

  /// The HTTP content type of to_text().
  static constexpr const char* kContentType = "text/plain; version=0.0.4; charset=utf-8";

 private:
  /// The metrics of one name; exactly one pointer is not null.
  struct Family {
    std::unique_ptr<MetricFamily<Counter>> counters;
    std::unique_ptr<MetricFamily<Gauge>> gauges;
    std::unique_ptr<MetricFamily<Histogram>> histograms;
    std::vector<double> bounds;
  };

  Family& family(const MetricInfo& info) ENGRAM_REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::map<std::string, Family> families_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
