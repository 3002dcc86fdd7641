// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rpc/metric_registry.h"

namespace engram::server {

/// Metrics of the requests to a server.
///
/// Threading: thread-safe.
struct RpcMetrics {
  MetricRegistry registry;
  Counter& commits = registry.counter("engram_commits_total", "Commits that came.");
  Counter& refused_commits =
      registry.counter("engram_commits_refused_total", "Commits that were not taken.");
  Counter& queries = registry.counter("engram_queries_total", "Queries that came.");
  Counter& failed_queries =
      registry.counter("engram_queries_failed_total", "Queries that ended with an error.");
  Counter& events = registry.counter("engram_events_told_total",
                                     "Snapshots that were told to subscribers, once for each.");
  Counter& lost_events = registry.counter(
      "engram_events_lost_total", "Snapshots that slow subscribers were not told, once for each.");
  Counter& refused_streams = registry.counter(
      "engram_streams_refused_total", "Streams without a token that is known, or too many.");
  Counter& broken_requests = registry.counter(
      "engram_requests_broken_total", "Requests that are no message: they end their stream.");
  Counter& refused_rates = registry.counter("engram_requests_over_rate_total",
                                            "Requests beyond the rate of their token.");
  Counter& refused_calls = registry.counter(
      "engram_calls_refused_total", "Calls without a token that is known, or that may do this.");
  Counter& forgettings =
      registry.counter("engram_forgettings_total", "Requests to forget that may do it.");
  Counter& similar =
      registry.counter("engram_similar_total", "Questions about likeness that came.");
  Counter& failed_similar = registry.counter("engram_similar_failed_total",
                                             "Questions about likeness that ended with an error.");
  Gauge& streams = registry.gauge("engram_streams", "Streams that are open.");
};

}  // namespace engram::server
