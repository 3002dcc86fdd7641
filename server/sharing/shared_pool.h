// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/sharing/block_ref.h"
#include "server/sharing/descriptor.h"

namespace engram::server {

/// The current contents of a pool, and what it has refused so far.
struct PoolCounters {
  size_t clients = 0;
  size_t slabs = 0;
  size_t slab_bytes = 0;
  size_t blocks = 0;       ///< Leased to writers, or committed.
  size_t uncommitted = 0;  ///< Those of them that writers still fill.
  size_t block_bytes = 0;  ///< Total size of all blocks.
  size_t shares = 0;       ///< Blocks that readers have, counted once per reader.
  uint64_t exhausted = 0;  ///< Leases and shares refused because of a limit.
  uint64_t refused = 0;    ///< Requests for blocks and slabs that were not the client's.
};

/// Shared memory that the server owns and leases in blocks to processes of its host.
///
/// A block is free, then leased (lease(): its writer fills it), then committed (commit(): it can be
/// read), and free again when no Buffer of the server views it and no reader has it. When a client
/// is removed, everything it had is taken back. Each name that a client sends is compared with what
/// it was given, and any other name is refused.
/// Threading: thread-safe. Buffers may outlive the pool.
/// Complexity: O(log of the blocks in a slab), about a microsecond.
/// Source: docs/sharing.md.
class SharedPool {
 public:
  struct Options {
    /// Max size of all slabs. A page takes RAM only once it is written.
    size_t max_bytes = size_t{1} << 30;
    /// Max size of the slabs of one writer.
    size_t max_writer_bytes = size_t{512} << 20;
    /// Max blocks of one writer; each costs about 150 bytes beside its contents.
    size_t max_writer_blocks = size_t{1} << 16;
    /// Max size of the blocks that one reader has at once, which bounds what a reader that never
    /// releases a block can withhold.
    size_t max_reader_bytes = size_t{512} << 20;
    /// Size of the first slab of a writer and group. Each further slab doubles their memory.
    size_t first_slab_bytes = size_t{4} << 20;
    /// Max size of a further slab. A block that is larger has a slab of its own.
    size_t slab_bytes = size_t{64} << 20;
    /// How long a slab without blocks is kept. A longer time saves page faults of later bursts and
    /// costs the RAM of the slab.
    Duration keep_free = std::chrono::seconds(10);

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument.
  static Result<std::unique_ptr<SharedPool>> create(const Options& options);
  ~SharedPool();

  /// Adds a client.
  /// Errors: kAlreadyExists; kInvalidArgument for kServerItself.
  Status add_client(ClientId client);

  /// Removes a client: takes back what it leased and did not commit, and what it read of others.
  /// What it committed stays as long as it is read. Does nothing if there is no such client.
  void remove_client(ClientId client);

  /// Allows a client to map, and to be given, blocks that writers of the group commit.
  /// Errors: kFailedPrecondition if there is no such client.
  Status grant_read(ClientId client, GroupId group);

  /// Leases a block for at least `bytes`.
  /// Errors: kFailedPrecondition if there is no such client; kInvalidArgument for zero bytes;
  /// kResourceExhausted beyond a limit, in which case the client sends plain bytes.
  Result<BlockRef> lease(ClientId writer, GroupId group, size_t bytes);

  /// Returns the bytes of a block that the server itself leased and has not committed.
  /// Errors: kInvalidArgument.
  Result<std::span<std::byte>> writable(const BlockRef& block);

  /// Commits the first `bytes` of a block. The returned Buffer, or any slice of it, keeps the
  /// block.
  /// Errors: kInvalidArgument unless the block is the writer's, of this group and uncommitted, and
  /// `bytes` is from 1 to its capacity; kFailedPrecondition if the writer never mapped it.
  Result<Buffer> commit(ClientId writer, GroupId group, const BlockRef& block, size_t bytes);

  /// Gives back a lease that was not committed.
  /// Errors: kInvalidArgument.
  Status abandon(ClientId writer, const BlockRef& block);

  /// Makes one more Buffer of a committed block.
  /// Errors: kInvalidArgument.
  Result<Buffer> view(const BlockRef& block, size_t bytes);

  /// The place of a Buffer's bytes in this pool.
  struct Located {
    BlockRef block;
    uint64_t offset = 0;  ///< Offset in the block.
  };

  /// Finds the block that contains `bytes`; nothing if they are not in this pool. A Buffer of them
  /// must live during the call.
  [[nodiscard]] std::optional<Located> locate(std::span<const std::byte> bytes) const;

  /// Gives a reader one lease of a committed block, until it is released or the reader is removed.
  /// Errors: kInvalidArgument; kFailedPrecondition if the reader has no grant or is gone;
  /// kResourceExhausted beyond max_reader_bytes.
  Status share(const BlockRef& block, ClientId reader);

  /// Releases `count` leases of a reader.
  /// Errors: kInvalidArgument if the reader has fewer.
  Status release(ClientId reader, const BlockRef& block, uint64_t count = 1);

  /// What a client needs to map a slab.
  struct OpenedSlab {
    Descriptor memory;
    size_t bytes = 0;
    bool is_writer = false;  ///< The client must report its mapping, so that seal() is called.
  };

  /// Opens a slab for a client.
  /// Errors: kNotFound if there is none or the client has no grant; kFailedPrecondition if its
  /// writer must map it first, or has already mapped it.
  Result<OpenedSlab> open_slab(ClientId client, SlabId slab);

  /// Called when the writer has mapped a slab: from then on nobody can map it for writing.
  /// Errors: kNotFound unless the slab is this writer's; kFailedPrecondition; kUnavailable.
  Status seal(ClientId writer, SlabId slab);

  [[nodiscard]] bool has_slab(SlabId slab) const;

  /// Gives back slabs that had no block for keep_free. To be called at intervals.
  void trim(Time now);

  [[nodiscard]] PoolCounters counters() const;

 private:
  struct State;
  struct View;
  explicit SharedPool(std::shared_ptr<State> state);

  std::shared_ptr<State> state_;
};

}  // namespace engram::server
