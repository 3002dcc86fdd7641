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

/// What metrics of one name have in common.
struct MetricInfo {
  std::string name;                 ///< "engram_commits_total"; times in seconds, sizes in bytes.
  std::string help;                 ///< One sentence for people.
  std::vector<std::string> labels;  ///< Names of the labels that tell them apart.

  friend bool operator==(const MetricInfo&, const MetricInfo&) = default;
};

/// The metrics of one name: one for each combination of the labels' values.
///
/// Look one up once and keep the reference, which stays valid as long as the registry: counting
/// then takes no lock.
/// Threading: thread-safe.
template <typename Metric>
class MetricFamily {
 public:
  /// Label values may come from outside: what they take is bounded. From so many combinations on,
  /// new ones are counted together, with `other` as the value of every label.
  static constexpr size_t kMaxSeries = 1000;
  /// Longer values are cut.
  static constexpr size_t kMaxValueBytes = 256;

  using Make = std::function<std::unique_ptr<Metric>()>;
  using Series = std::map<std::vector<std::string>, std::unique_ptr<Metric>>;

  MetricFamily(MetricInfo info, Make make) : info_(std::move(info)), make_(std::move(make)) {}

  /// The one whose labels have these values, made on first use. Needs one per label (checked).
  /// Bytes that are no UTF-8 become question marks.
  Metric& with(std::vector<std::string> values);

  [[nodiscard]] const MetricInfo& info() const { return info_; }

  /// Calls `visit(values, metric)` for each, in the order of their values.
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

/// All that a server counts and measures, and its text for Prometheus (format 0.0.4).
///
/// Debian has prometheus-cpp, but that brings an HTTP server of its own into the process
/// (civetweb); what is needed of it is this one text, which whatever listens already can hand out.
/// Asking for a name again gives the same metrics; with another kind, help, labels or bounds it is
/// a bug of ours and aborts, as do names that Prometheus does not know. Threading: thread-safe.
class MetricRegistry {
 public:
  MetricFamily<Counter>& counters(MetricInfo info);
  MetricFamily<Gauge>& gauges(MetricInfo info);
  /// `bounds` are those of Histogram. The label `le` is its own.
  MetricFamily<Histogram>& histograms(MetricInfo info,
                                      const std::vector<double>& bounds = latency_bounds());

  /// The same for a metric that has no labels.
  Counter& counter(std::string name, std::string help);
  Gauge& gauge(std::string name, std::string help);
  Histogram& histogram(std::string name, std::string help,
                       const std::vector<double>& bounds = latency_bounds());

  /// What Prometheus reads, in the order of the names.
  [[nodiscard]] std::string to_text() const;

  /// What to_text is, for HTTP.
  static constexpr const char* kContentType = "text/plain; version=0.0.4; charset=utf-8";

 private:
  /// One of them is not null.
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
