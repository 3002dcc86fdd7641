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

/// What the pool knows of one process.
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
  std::unordered_map<uint64_t, Share> shares;  ///< By generation.
  size_t shared_bytes = 0;
};

/// Unmapped when no lock is held: that takes as long as there are pages.
using Dropped = std::vector<std::unique_ptr<DividedSlab>>;

/// The books of a SharedPool: what is whose.
///
/// Threading: everything but `options` under `mutex`. What is called with `dropped` puts slabs
/// there that are to go when it is no longer held.
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

  /// Null where there is none.
  [[nodiscard]] PoolClient* find(ClientId client) const ENGRAM_REQUIRES(mutex);
  [[nodiscard]] DividedSlab* find_slab(SlabId slab) const ENGRAM_REQUIRES(mutex);

  /// The block of exactly this name, unless it is free or another's by now.
  [[nodiscard]] std::optional<BlockSpace::Taken> find_block(const BlockRef& block) const
      ENGRAM_REQUIRES(mutex);

  /// The same, where `writer` has it and did not commit it.
  [[nodiscard]] std::optional<BlockSpace::Taken> find_lease(ClientId writer,
                                                            const BlockRef& block) const
      ENGRAM_REQUIRES(mutex);

  /// Counts what is refused. Errors: kInvalidArgument, kResourceExhausted.
  Status refuse(std::string_view what, const BlockRef& block, std::string_view needed)
      ENGRAM_REQUIRES(mutex);
  Status exhaust(std::string_view what, size_t found, size_t needed) ENGRAM_REQUIRES(mutex);

  /// What its blocks of a group lie in.
  std::shared_ptr<BlockSpace>& space_of(PoolClient& client, GroupId group) ENGRAM_REQUIRES(mutex);

  /// Errors: kResourceExhausted, kUnavailable.
  Status add_slab(PoolClient& writer, BlockSpace& space, size_t bytes, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);

  /// Of the slabs without blocks.
  void drop_where(const std::function<bool(DividedSlab&)>& is_dropped, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);

  void free_block(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);
  void free_if_unused(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped)
      ENGRAM_REQUIRES(mutex);

  /// Takes back whatever it had, and forgets it.
  void remove(PoolClient& client, Dropped& dropped) ENGRAM_REQUIRES(mutex);

 private:
  void drop(DividedSlab& slab, Dropped& dropped) ENGRAM_REQUIRES(mutex);
  void forget_writer(PoolClient& client, Dropped& dropped) ENGRAM_REQUIRES(mutex);
};

}  // namespace engram::server
