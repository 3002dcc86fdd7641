// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/age_objects.h"

namespace engram::experiments {

/// How data get from the producer's process to the consumer's.
enum class AgeWay {
  kDirect,       ///< A stream from one to the other.
  kRelay,        ///< Streams over a process that passes bytes on, unread.
  kMemory,       ///< Commit; the notification brings the data.
  kMemoryQuery,  ///< Commit; the notification brings IDs, which are queried for.
};

[[nodiscard]] const char* to_string(AgeWay way);

/// Lets ways without the memory, which are plain gRPC, use its polling threads.
void tune_plain_grpc();

/// Keeps on serving until it is destroyed.
class AgeRole {
 public:
  virtual ~AgeRole() = default;
};

/// The process in the middle: a memory server that holds `entries` snapshots, or a relay.
Result<std::unique_ptr<AgeRole>> start_memory(const std::string& endpoint, int entries);
Result<std::unique_ptr<AgeRole>> start_relay(const std::string& endpoint);

/// Calls `on_age` with the age of each commit that came, when all its data are there as values.
/// Unit: ns.
Result<std::unique_ptr<AgeRole>> start_consumer(AgeWay way, const std::string& endpoint, int batch,
                                                std::function<void(int64_t)> on_age);

class AgeProducer {
 public:
  virtual ~AgeProducer() = default;
  /// Sends a commit, and does not wait for its acknowledgement.
  virtual Status send(const ltm::Commit& commit) = 0;
  /// How long a commit takes until it is acknowledged; needs kMemory. Unit: ns.
  virtual Result<int64_t> acknowledged(const ltm::Commit& commit) = 0;
};

Result<std::unique_ptr<AgeProducer>> start_producer(AgeWay way, const std::string& endpoint);

}  // namespace engram::experiments
