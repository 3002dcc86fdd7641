// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/age_objects.h"

namespace engram::experiments {

/// The way of data from the producer's process to the consumer's.
enum class AgeWay {
  kDirect,       ///< A stream from one to the other.
  kRelay,        ///< Streams through a process that forwards bytes without reading them.
  kMemory,       ///< Commit; the notification contains the data.
  kMemoryQuery,  ///< Commit; the notification contains IDs, for which the consumer queries.
};

[[nodiscard]] const char* to_string(AgeWay way);

/// Makes the ways without the memory, which are plain gRPC, use the memory's polling threads.
void tune_plain_grpc();

/// Serves until it is destroyed.
class AgeRole {
 public:
  virtual ~AgeRole() = default;
};

/// Starts the process in the middle: a memory server that holds `entries` snapshots, or a relay.
Result<std::unique_ptr<AgeRole>> start_memory(const std::string& endpoint, int entries);
Result<std::unique_ptr<AgeRole>> start_relay(const std::string& endpoint);

/// Calls `on_age` with the age of each commit that arrives, when all its data are available as
/// values. Unit: ns.
Result<std::unique_ptr<AgeRole>> start_consumer(AgeWay way, const std::string& endpoint, int batch,
                                                std::function<void(int64_t)> on_age);

class AgeProducer {
 public:
  virtual ~AgeProducer() = default;
  /// Sends a commit without waiting for its acknowledgement.
  virtual Status send(const ltm::Commit& commit) = 0;
  /// Returns the time until a commit is acknowledged; only for kMemory. Unit: ns.
  virtual Result<int64_t> acknowledged(const ltm::Commit& commit) = 0;
};

Result<std::unique_ptr<AgeProducer>> start_producer(AgeWay way, const std::string& endpoint);

}  // namespace engram::experiments
