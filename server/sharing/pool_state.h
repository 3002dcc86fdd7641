// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_map>
#include <vector>

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

  mutable std::mutex mutex;
  std::unordered_map<ClientId, std::unique_ptr<PoolClient>> clients;
  std::unordered_map<SlabId, std::unique_ptr<DividedSlab>> slabs;
  std::map<const std::byte*, DividedSlab*> by_address;
  SlabId last_slab = 0;
  uint64_t last_generation = 0;
  PoolCounters counts;

  /// Null where there is none.
  [[nodiscard]] PoolClient* find(ClientId client) const;
  [[nodiscard]] DividedSlab* find_slab(SlabId slab) const;

  /// The block of exactly this name, unless it is free or another's by now.
  [[nodiscard]] std::optional<BlockSpace::Taken> find_block(const BlockRef& block) const;

  /// The same, where `writer` has it and did not commit it.
  [[nodiscard]] std::optional<BlockSpace::Taken> find_lease(ClientId writer,
                                                            const BlockRef& block) const;

  /// Counts what is refused. Errors: kInvalidArgument, kResourceExhausted.
  Status refuse(std::string_view what, const BlockRef& block, std::string_view needed);
  Status exhaust(std::string_view what, size_t found, size_t needed);

  /// What its blocks of a group lie in.
  std::shared_ptr<BlockSpace>& space_of(PoolClient& client, GroupId group);

  /// Errors: kResourceExhausted, kUnavailable.
  Status add_slab(PoolClient& writer, BlockSpace& space, size_t bytes, Dropped& dropped);

  /// Of the slabs without blocks.
  void drop_where(const std::function<bool(DividedSlab&)>& is_dropped, Dropped& dropped);

  void free_block(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped);
  void free_if_unused(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped);

  /// Takes back whatever it had, and forgets it.
  void remove(PoolClient& client, Dropped& dropped);

 private:
  void drop(DividedSlab& slab, Dropped& dropped);
  void forget_writer(PoolClient& client, Dropped& dropped);
};

}  // namespace engram::server
