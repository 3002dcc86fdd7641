// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/memory/query.h"
#include "ltm/memory/snapshot.h"

namespace engram {

/// A snapshot as subscribers are told of it.
struct ToldSnapshot {
  ltm::Snapshot snapshot;
  bool has_data = false;  ///< False: its instances are empty, only their number counts.
};

struct SubscriptionOptions {
  /// Patterns of entities, as in queries ("Vision/.*/head/cam"); empty: everything.
  std::vector<std::string> names;
  bool with_data = false;
  /// Snapshots with more plain bytes are told without their data; 0: no limit.
  size_t inline_bytes = 0;
  /// The bound of snapshots that wait for this subscriber; beyond it the oldest are dropped. 0:
  /// 1,024.
  size_t queue_bound = 0;
};

/// A query that matches the entities of a subscription.
/// Errors: kInvalidArgument naming the pattern, or where there are more than 256.
Result<ltm::Query> subscribed_names(const std::vector<std::string>& names);

/// A subscription lasts until it is destroyed.
///
/// Threading: one thread; no handler is called after the destructor.
class Subscription {
 public:
  virtual ~Subscription() = default;
};

/// Handlers are called by a thread of the memory, one at a time, and must not wait for the memory.
struct SubscriptionHandlers {
  std::function<void(std::vector<ToldSnapshot>)> on_snapshots;
  /// Reports how many snapshots were dropped since the last call, because this subscriber was too
  /// slow.
  std::function<void(uint64_t lost)> on_lost;
  /// The connection to the server was lost, and with it the commits until the subscription is in
  /// place again, which happens by itself. Never called by a memory that this program opened.
  std::function<void(const Status&)> on_interrupted;
};

}  // namespace engram
