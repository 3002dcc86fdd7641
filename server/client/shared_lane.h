// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.grpc.pb.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/commit.h"
#include "server/client/client_options.h"
#include "server/sharing/sharing_client.h"
#include "server/wire/wire_block.h"

namespace engram::server {

/// Payloads of at least this size go through shared memory if the server is on this host.
inline constexpr size_t kSharedPayloadBytes = size_t{32} << 10;

/// Memory that a client shares with its server: a session, and blocks leased to it.
///
/// Threading: thread-safe. Buffers may outlive this object.
/// Source: docs/sharing.md.
class SharedLane {
 public:
  /// Asks the server for a session. Returns null if the server offers none or cannot be asked.
  static std::shared_ptr<SharedLane> open(v1::MemoryServer::Stub& stub,
                                          const ClientOptions& options);

  /// The session's name, which streams send in their metadata.
  [[nodiscard]] const std::string& session() const { return session_; }
  [[nodiscard]] bool is_alive() const { return memory_->is_connected(); }
  [[nodiscard]] SharingClient& memory() { return *memory_; }

  /// Takes a leased block of this memory that has at least `bytes`; nothing if there is none.
  std::optional<BlockRef> take_lease(const std::string& memory, size_t bytes);
  /// Keeps a block for a later take_lease().
  void keep_lease(const std::string& memory, const BlockRef& block);

 private:
  struct Lease {
    std::string memory;
    BlockRef block;
  };
  /// The max number of kept leases. A block beyond it stays unused until this client ends.
  static constexpr size_t kMaxLeases = 8;

  std::string session_;
  std::unique_ptr<SharingClient> memory_;
  Mutex mutex_;
  std::vector<Lease> leases_ ENGRAM_GUARDED_BY(mutex_);
};

/// The number of bytes that write_in_block needs for the data of a commit.
[[nodiscard]] size_t bytes_in_block(const ltm::Commit& commit);

/// The memory that all updates belong to; nothing if they belong to several.
[[nodiscard]] std::optional<std::string> memory_of(const ltm::Commit& commit);

/// Writes to `request` what a commit says besides its data, and where these lie in a block.
void describe_in_block(const ltm::Commit& commit, v1::CommitRequest& request);

/// Whether bytes are read soon after they were written, or never as a rule: these are written past
/// the processor's caches.
enum class ReadBack : bool { kSoon, kSeldom };

/// Writes the data of a commit to `out`, where describe_in_block() says.
/// Errors: kInvalidArgument if a value nests too deep.
Status write_data(const ltm::Commit& commit, std::span<std::byte> out, ReadBack read);

/// Both.
/// Errors: those of write_data().
Status write_in_block(const ltm::Commit& commit, std::span<std::byte> out,
                      v1::CommitRequest& request);

}  // namespace engram::server
