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

/// A snapshot that a subscriber is told of.
struct ToldSnapshot {
  ltm::Snapshot snapshot;
  bool has_data = false;  ///< Else it has as many empty instances as there are.
};

struct SubscriptionOptions {
  /// Entities, as in queries ("Vision/.*/head/cam"); none: everything.
  std::vector<std::string> names;
  bool with_data = false;
  size_t inline_bytes = 0;  ///< Larger ones are told by their ID alone; 0: no limit.
  size_t queue_bound = 0;   ///< Of what may wait for this subscriber; 0: the default, 1,024.
};

/// The entities of a subscription, as a query that matches them.
/// Errors: kInvalidArgument naming the pattern, or where there are more than 256.
Result<ltm::Query> subscribed_names(const std::vector<std::string>& names);

/// Told until it is destroyed.
///
/// Threading: one thread; no handler is called after the destructor.
class Subscription {
 public:
  virtual ~Subscription() = default;
};

/// Handlers are called by a thread of the memory, one at a time, and must not wait for it.
struct SubscriptionHandlers {
  std::function<void(std::vector<ToldSnapshot>)> on_snapshots;
  /// So many were not told since the last time: this subscriber was too slow.
  std::function<void(uint64_t lost)> on_lost;
  /// The server was lost, and what it told meanwhile with it; it is subscribed to again by itself.
  /// Never called by a memory that this program opened.
  std::function<void(const Status&)> on_interrupted;
};

}  // namespace engram
