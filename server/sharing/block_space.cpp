// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/block_space.h"

#include "ltm/core/check.h"

namespace engram::server {

void BlockSpace::offer(DividedSlab& slab, DividedSlab::Place place) {
  free.insert({place->second.length, slab.id, place->first, &slab});
}

void BlockSpace::withdraw(DividedSlab& slab, DividedSlab::Place place) {
  free.erase({place->second.length, slab.id, place->first, &slab});
}

void BlockSpace::add(DividedSlab& slab) {
  bytes += slab.size();
  slab.blocks.clear();
  Block all;
  all.length = slab.size();
  offer(slab, slab.blocks.emplace(0, all).first);
}

void BlockSpace::remove(DividedSlab& slab) {
  ENGRAM_CHECK(slab.taken == 0, "slab {} has {} blocks in use", slab.id, slab.taken);
  bytes -= slab.size();
  withdraw(slab, slab.blocks.begin());
}

std::optional<BlockSpace::Taken> BlockSpace::take(uint64_t length, uint64_t generation) {
  const auto found = free.lower_bound({length, 0, 0, nullptr});
  if (found == free.end()) return std::nullopt;
  DividedSlab& slab = *found->owner;
  const auto place = slab.blocks.find(found->offset);
  free.erase(found);
  if (place->second.length > length) {
    Block rest;
    rest.length = place->second.length - length;
    offer(slab, slab.blocks.emplace_hint(std::next(place), place->first + length, rest));
  }
  place->second = {length, generation, 0, 0, 0};
  ++slab.taken;
  slab.free_since.reset();
  return Taken{&slab, place};
}

void BlockSpace::give_back(DividedSlab& slab, DividedSlab::Place place) {
  --slab.taken;
  place->second = {place->second.length, 0, 0, 0, 0};
  if (const auto next = std::next(place); next != slab.blocks.end() && next->second.is_free()) {
    withdraw(slab, next);
    place->second.length += next->second.length;
    slab.blocks.erase(next);
  }
  if (place != slab.blocks.begin() && std::prev(place)->second.is_free()) {
    const auto before = std::prev(place);
    withdraw(slab, before);
    before->second.length += place->second.length;
    slab.blocks.erase(place);
    place = before;
  }
  offer(slab, place);
}

}  // namespace engram::server
