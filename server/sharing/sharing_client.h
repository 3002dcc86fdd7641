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

/// The memory of a server of this host, as one of its clients sees it.
///
/// Slabs are mapped when a block of them is first asked for, and stay mapped until the server gives
/// them back. A thread of its own listens to the server. When that ends, so does this: everything
/// returns kUnavailable, and Buffers that were made stay readable.
/// Threading: thread-safe. Buffers may outlive it.
/// Source: docs/sharing.md.
class SharingClient {
 public:
  struct Options {
    /// How long the server may take to answer; only connecting and new slabs ask it.
    Duration timeout = std::chrono::seconds(2);
    std::vector<uid_t> other_uids;  ///< Whose servers are trusted beside this user's and root's.

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  /// Shows the ticket to the server at `socket`.
  /// Errors: kUnavailable where there is no server, kFailedPrecondition where it is another
  /// user's, kInvalidArgument; those of the server: kNotFound for a ticket that is not good,
  /// kAlreadyExists, kResourceExhausted.
  static Result<std::unique_ptr<SharingClient>> connect(const std::filesystem::path& socket,
                                                        const Ticket& ticket,
                                                        const Options& options);
  ~SharingClient();

  /// Where the bytes of a block go that this client has leased. Valid until it is committed or
  /// given back, and no longer than this client.
  /// Errors: kUnavailable; kInvalidArgument where the block does not lie in its slab or the slab is
  /// another's; those of SharedPool::open_slab.
  Result<std::span<std::byte>> writable(const BlockRef& block);

  /// Called when the last copy of a Buffer goes, on whichever thread that is.
  using OnRelease = std::function<void(const BlockRef&)>;

  /// The first `bytes` of a block that the server shared, mapped for reading alone. When its last
  /// copy goes, its lease is the server's again: `on_release` or else take_released() says so.
  /// Errors: as writable(). The lease then stays to be released.
  Result<Buffer> readable(const BlockRef& block, size_t bytes, OnRelease on_release = {});

  /// The leases that went since it was last called, to be told to the server. Those of one block
  /// that was shared several times are in it as often.
  std::vector<BlockRef> take_released();

  [[nodiscard]] bool is_connected() const;

 private:
  struct State;
  explicit SharingClient(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::server
