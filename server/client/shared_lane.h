// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.grpc.pb.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/commit.h"
#include "server/client/memory_client.h"
#include "server/sharing/sharing_client.h"
#include "server/wire/wire_block.h"

namespace engram::server {

/// Payloads from here on go through shared memory where the server is on this host.
inline constexpr size_t kSharedPayloadBytes = size_t{32} << 10;

/// Memory that a client shares with its server: a session, and blocks that are leased to it.
///
/// Threading: thread-safe. Buffers may outlive it.
/// Source: docs/sharing.md.
class SharedLane {
 public:
  /// Asks the server for a session. Null where it offers none, or cannot be asked.
  static std::shared_ptr<SharedLane> open(v1::MemoryServer::Stub& stub,
                                          const ClientOptions& options);

  /// For the metadata of streams.
  [[nodiscard]] const std::string& session() const { return session_; }
  [[nodiscard]] bool is_alive() const { return memory_->is_connected(); }
  [[nodiscard]] SharingClient& memory() { return *memory_; }

  /// A block that was leased for this memory and is large enough, if there is one.
  std::optional<BlockRef> take_lease(const std::string& memory, size_t bytes);
  void keep_lease(const std::string& memory, const BlockRef& block);

 private:
  struct Lease {
    std::string memory;
    BlockRef block;
  };
  /// Beyond that, the server keeps what it leases until this client ends.
  static constexpr size_t kMaxLeases = 8;

  std::string session_;
  std::unique_ptr<SharingClient> memory_;
  Mutex mutex_;
  std::vector<Lease> leases_ ENGRAM_GUARDED_BY(mutex_);
};

/// Bytes that write_in_block needs for the data of a commit.
[[nodiscard]] size_t bytes_in_block(const ltm::Commit& commit);

/// The memory of all updates; nothing where there are several.
[[nodiscard]] std::optional<std::string> memory_of(const ltm::Commit& commit);

/// Writes the data of a commit to `out`, and the rest of it to `request`.
/// Errors: kInvalidArgument where a value nests too deep.
Status write_in_block(const ltm::Commit& commit, std::span<std::byte> out,
                      v1::CommitRequest& request);

}  // namespace engram::server
