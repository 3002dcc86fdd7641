// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/sharing/block_ref.h"

namespace engram::server {

/// A client's view of the shared memory of a server on this host.
///
/// A slab is mapped when one of its blocks is first used, and stays mapped until the server gives
/// it back. A thread of this object listens to the server. Once the connection has ended, every
/// call returns kUnavailable; existing Buffers stay readable.
/// Threading: thread-safe. Buffers may outlive this object.
/// Source: docs/sharing.md.
class SharingClient {
 public:
  struct Options {
    /// How long the server may take to answer. Only connecting and new slabs ask the server.
    Duration timeout = std::chrono::seconds(2);
    std::vector<uid_t> other_uids;  ///< Users whose servers are trusted, beside this user and root.

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  /// Connects to the server at `socket` and presents the ticket.
  /// Errors: kUnavailable if there is no server; kFailedPrecondition if it is another user's;
  /// kInvalidArgument; those of the server: kNotFound for an invalid ticket, kAlreadyExists,
  /// kResourceExhausted.
  static Result<std::unique_ptr<SharingClient>> connect(const std::filesystem::path& socket,
                                                        const Ticket& ticket,
                                                        const Options& options);
  ~SharingClient();

  /// Returns the memory of a block that this client has leased. It is valid until the block is
  /// committed or given back, and no longer than this client lives.
  /// Errors: kUnavailable; kInvalidArgument if the block is not within its slab or the slab is
  /// another writer's; those of SharedPool::open_slab.
  Result<std::span<std::byte>> writable(const BlockRef& block);

  /// The memory of a block that stays mapped as long as `owner` lives, also after the server took
  /// the block back: writing to it harms nobody then.
  struct KeptBlock {
    std::shared_ptr<const void> owner;
    std::span<std::byte> bytes;
  };
  /// Errors: those of writable().
  Result<KeptBlock> keep_writable(const BlockRef& block);

  /// Called when the last copy of a Buffer is destroyed, on that thread.
  using OnRelease = std::function<void(const BlockRef&)>;

  /// Maps the first `bytes` of a shared block read-only. When the last copy of the Buffer is
  /// destroyed, its lease must go back to the server: `on_release` reports it, or take_released()
  /// if there is none.
  /// Errors: those of writable(); the lease must then still be released.
  Result<Buffer> readable(const BlockRef& block, size_t bytes, OnRelease on_release = {});

  /// Returns the leases that ended since the last call, to be released at the server. A block that
  /// was shared several times appears as often.
  std::vector<BlockRef> take_released();

  [[nodiscard]] bool is_connected() const;

 private:
  struct State;
  explicit SharingClient(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::server
