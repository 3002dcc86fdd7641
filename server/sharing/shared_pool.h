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

/// What is in a pool now, and what it refused since it was made.
struct PoolCounters {
  size_t clients = 0;
  size_t slabs = 0;
  size_t slab_bytes = 0;
  size_t blocks = 0;       ///< Leased to writers or committed.
  size_t uncommitted = 0;  ///< Of these: that writers have.
  size_t block_bytes = 0;  ///< Of all blocks.
  size_t shares = 0;       ///< Blocks that readers have, counted for each reader.
  uint64_t exhausted = 0;  ///< Leases and shares that a limit refused.
  uint64_t refused = 0;    ///< Blocks and slabs asked for that were not the client's to ask for.
};

/// Shared memory that the server owns and leases to processes of its host, in blocks.
///
/// A block goes from free to leased (`lease`: its writer fills it) to committed (`commit`: it is
/// read), and is free again when no Buffer of the server views it and no reader has it. Whatever a
/// process had is taken back when it is removed. What a client names is compared with what it was
/// given; a client that names what it has not got is refused.
/// Threading: thread-safe. Buffers may outlive the pool.
/// Complexity: O(log of the blocks in a slab), about a microsecond.
/// Source: docs/sharing.md.
class SharedPool {
 public:
  struct Options {
    /// Of all slabs. RAM is taken when a page is first written.
    size_t max_bytes = size_t{1} << 30;
    /// Of the slabs of one writer.
    size_t max_writer_bytes = size_t{512} << 20;
    /// Of one writer; one costs about 150 bytes beside its contents.
    size_t max_writer_blocks = size_t{1} << 16;
    /// Of the blocks that one reader has at once: what a reader that never lets go can withhold.
    size_t max_reader_bytes = size_t{512} << 20;
    /// Of the first slab of a writer and group; as much is added each time as there is,
    size_t first_slab_bytes = size_t{4} << 20;
    /// up to this. Larger blocks have a slab of their own.
    size_t slab_bytes = size_t{64} << 20;
    /// A slab without blocks is given back after this.
    Duration keep_free = std::chrono::seconds(10);

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument.
  static Result<std::unique_ptr<SharedPool>> create(const Options& options);
  ~SharedPool();

  /// Errors: kAlreadyExists, kInvalidArgument for kServerItself.
  Status add_client(ClientId client);

  /// Takes back what it leased and did not commit, and what it had of others. What it committed
  /// stays as long as it is read. Fine where there is none.
  void remove_client(ClientId client);

  /// From now on it may map what the group's writers commit, and be given blocks of it.
  /// Errors: kFailedPrecondition where there is no such client.
  Status grant_read(ClientId client, GroupId group);

  /// A block for at least so many bytes.
  /// Errors: kFailedPrecondition where there is no such client, kInvalidArgument for no bytes,
  /// kResourceExhausted beyond a limit: send plain bytes instead.
  Result<BlockRef> lease(ClientId writer, GroupId group, size_t bytes);

  /// What the server itself leased and has not committed.
  /// Errors: kInvalidArgument.
  Result<std::span<std::byte>> writable(const BlockRef& block);

  /// Takes the first `bytes` of a block as written. The Buffer keeps it; any slice of it does.
  /// Errors: kInvalidArgument unless it is the writer's, of this group, uncommitted, and has so
  /// many bytes, at least one; kFailedPrecondition where the writer never mapped it.
  Result<Buffer> commit(ClientId writer, GroupId group, const BlockRef& block, size_t bytes);

  /// Gives a lease back without having committed it.
  /// Errors: kInvalidArgument.
  Status abandon(ClientId writer, const BlockRef& block);

  /// One more Buffer of a committed block.
  /// Errors: kInvalidArgument.
  Result<Buffer> view(const BlockRef& block, size_t bytes);

  /// Where bytes of a Buffer lie that came from this pool.
  struct Located {
    BlockRef block;
    uint64_t offset = 0;  ///< In the block.
  };

  /// Nothing where they do not. A Buffer of them has to live meanwhile.
  [[nodiscard]] std::optional<Located> locate(std::span<const std::byte> bytes) const;

  /// Counts one lease of a committed block for a reader, until it is released or removed.
  /// Errors: kInvalidArgument; kFailedPrecondition where the reader has no grant or is gone;
  /// kResourceExhausted beyond max_reader_bytes.
  Status share(const BlockRef& block, ClientId reader);

  /// Errors: kInvalidArgument where the reader does not have it so many times.
  Status release(ClientId reader, const BlockRef& block, uint64_t count = 1);

  /// What a client maps a slab with.
  struct OpenedSlab {
    Descriptor memory;
    size_t bytes = 0;
    bool is_writer = false;  ///< Needs sealed() when it is mapped.
  };

  /// Errors: kNotFound where there is none or the client has no grant; kFailedPrecondition where
  /// its writer has to map it first, or has mapped it already.
  Result<OpenedSlab> open_slab(ClientId client, SlabId slab);

  /// Its writer has mapped it: nobody can map it for writing any more.
  /// Errors: kNotFound unless it is this writer's, kFailedPrecondition, kUnavailable.
  Status seal(ClientId writer, SlabId slab);

  [[nodiscard]] bool has_slab(SlabId slab) const;

  /// Gives slabs back that had no block for long enough. To be called now and then.
  void trim(Time now);

  [[nodiscard]] PoolCounters counters() const;

 private:
  struct State;
  struct View;
  explicit SharedPool(std::shared_ptr<State> state);

  std::shared_ptr<State> state_;
};

}  // namespace engram::server
