// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ltm/core/mutex.h"
#include "server/sharing/block_space.h"
#include "server/sharing/shared_pool.h"

namespace engram::server {

/// Blocks begin at whole pages. Unit: bytes.
inline constexpr size_t kPage = 4096;

/// The pool's record of one process.
struct PoolClient {
  ClientId id = kServerItself;
  std::set<GroupId> readable;
  std::map<GroupId, std::shared_ptr<BlockSpace>> spaces;
  size_t slab_bytes = 0;
  size_t blocks = 0;

  struct Share {
    DividedSlab* slab;
    DividedSlab::Place place;
    uint64_t count = 0;
  };
  std::unordered_map<uint64_t, Share> shares;  ///< Keyed by generation.
  size_t shared_bytes = 0;
};

/// Slabs to unmap after the lock is released: unmapping takes time in proportion to their pages.
using Dropped = std::vector<std::unique_ptr<DividedSlab>>;

/// The bookkeeping of a SharedPool: who owns and reads which block.
///
/// Threading: everything but `options` needs `mutex`. Functions with a parameter `dropped` move
/// slabs there that must be destroyed after the mutex is released.
struct SharedPool::State {
  explicit State(const Options& given) : options(given) {}

  const Options options;

  mutable Mutex mutex;
  std::unordered_map<ClientId, std::unique_ptr<PoolClient>> clients ENGRAM_GUARDED_BY(mutex);
  std::unordered_map<SlabId, std::unique_ptr<DividedSlab>> slabs ENGRAM_GUARDED_BY(mutex);
  std::map<const std::byte*, DividedSlab*> by_address ENGRAM_GUARDED_BY(mutex);
  SlabId last_slab ENGRAM_GUARDED_BY(mutex) = 0;
  uint64_t last_generation ENGRAM_GUARDED_BY(mutex) = 0;
  PoolCounters counts ENGRAM_GUARDED_BY(mutex);

  /// Returns null if there is none.
  [[nodiscard]] PoolClient* find(ClientId client) const ENGRAM_REQUIRES(mutex);
  [[nodiscard]] DividedSlab* find_slab(SlabId slab) const ENGRAM_REQUIRES(mutex);

  /// Returns the block with exactly this name, unless it is free or was leased again.
  [[nodiscard]] std::optional<BlockSpace::Taken> find_block(const BlockRef& block) const
      ENGRAM_REQUIRES(mutex);

  /// Like find_block(), if the block is leased to `writer` and not committed.
  [[nodiscard]] std::optional<BlockSpace::Taken> find_lease(ClientId writer,
                                                            const BlockRef& block) const
      ENGRAM_REQUIRES(mutex);

  /// Counts a refusal and returns its error.
  /// Errors: kInvalidArgument from refuse(), kResourceExhausted from exhaust().
  Status refuse(std::string_view what, const BlockRef& block, std::string_view needed)
      ENGRAM_REQUIRES(mutex);
  Status exhaust(std::string_view what, size_t found, size_t needed) ENGRAM_REQUIRES(mutex);

  /// Returns the space that holds a client's blocks of a group, and makes it on first use.
  std::shared_ptr<BlockSpace>& space_of(PoolClient& client, GroupId group) ENGRAM_REQUIRES(mutex);

  /// Errors: kResourceExhausted, kUnavailable.
  Status add_slab(PoolClient& writer, BlockSpace& space, size_t bytes, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);

  /// Drops the slabs without blocks that `is_dropped` selects.
  void drop_where(const std::function<bool(DividedSlab&)>& is_dropped, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);

  void free_block(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);
  void free_if_unused(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);

  /// Takes back everything that a client has, and forgets the client.
  void remove(PoolClient& client, Dropped& dropped) ENGRAM_REQUIRES(mutex);

 private:
  void drop(DividedSlab& slab, Dropped& dropped) ENGRAM_REQUIRES(mutex);
  void forget_writer(PoolClient& client, Dropped& dropped) ENGRAM_REQUIRES(mutex);
};

}  // namespace engram::server
