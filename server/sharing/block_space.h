// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "ltm/core/time.h"
#include "server/sharing/slab.h"

namespace engram::server {

struct PoolClient;

/// A part of a slab: free, leased to its writer, or committed.
struct Block {
  uint64_t length = 0;
  uint64_t generation = 0;  ///< Zero if free.
  uint64_t bytes = 0;       ///< Number of committed bytes; zero before the commit.
  uint64_t views = 0;       ///< Buffers of the server that view it.
  uint64_t shares = 0;      ///< Leases that readers hold.

  [[nodiscard]] bool is_free() const { return generation == 0; }
  [[nodiscard]] bool is_committed() const { return bytes > 0; }
  [[nodiscard]] bool is_unused() const { return is_committed() && views == 0 && shares == 0; }
};

struct BlockSpace;

/// A slab and its blocks, keyed by offset, without gaps.
struct DividedSlab {
  SlabId id = 0;
  Slab memory;
  std::shared_ptr<BlockSpace> space;
  std::map<uint64_t, Block> blocks;
  size_t taken = 0;  ///< Number of blocks that are not free.
  std::optional<Time> free_since;

  using Place = std::map<uint64_t, Block>::iterator;

  [[nodiscard]] size_t size() const { return memory.mapping()->size(); }
};

/// The slabs of one writer and one group. It decides where the next block goes.
///
/// It takes the smallest free range that is large enough, so that memory used before is preferred
/// to memory never used: pages stay resident, and slabs at the end become free.
/// Threading: one thread. Complexity: O(log of the free ranges).
struct BlockSpace {
  struct FreeRange {
    uint64_t length = 0;
    SlabId slab = 0;
    uint64_t offset = 0;
    DividedSlab* owner = nullptr;

    friend auto operator<=>(const FreeRange& a, const FreeRange& b) {
      if (const auto order = a.length <=> b.length; order != 0) return order;
      if (const auto order = a.slab <=> b.slab; order != 0) return order;
      return a.offset <=> b.offset;
    }
  };

  struct Taken {
    DividedSlab* slab;
    DividedSlab::Place place;
  };

  GroupId group = 0;
  PoolClient* writer = nullptr;  ///< Null if the writer is gone.
  std::set<FreeRange> free;
  size_t bytes = 0;  ///< Total size of all slabs.

  /// Adds a slab as one free range.
  void add(DividedSlab& slab);

  /// Removes a slab. Needs a slab whose blocks are all free (checked).
  void remove(DividedSlab& slab);

  /// Takes a block of exactly this length, a multiple of 64; nothing if no free range is large
  /// enough.
  std::optional<Taken> take(uint64_t length, uint64_t generation);

  /// Frees a block and joins it with its neighbours.
  void give_back(DividedSlab& slab, DividedSlab::Place place);

 private:
  void offer(DividedSlab& slab, DividedSlab::Place place);
  void withdraw(DividedSlab& slab, DividedSlab::Place place);
};

}  // namespace engram::server
