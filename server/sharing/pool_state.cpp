// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/pool_state.h"

#include <algorithm>
#include <bit>

namespace engram::server {

namespace {

constexpr size_t whole_pages(size_t bytes) {
  return (bytes + kPage - 1) / kPage * kPage;
}

}  // namespace

PoolClient* SharedPool::State::find(ClientId client) const {
  const auto found = clients.find(client);
  return found == clients.end() ? nullptr : found->second.get();
}

DividedSlab* SharedPool::State::find_slab(SlabId slab) const {
  const auto found = slabs.find(slab);
  return found == slabs.end() ? nullptr : found->second.get();
}

std::optional<BlockSpace::Taken> SharedPool::State::find_block(const BlockRef& block) const {
  DividedSlab* const slab = find_slab(block.slab);
  if (slab == nullptr || block.generation == 0) return std::nullopt;
  const auto place = slab->blocks.find(block.offset);
  if (place == slab->blocks.end() || place->second.generation != block.generation ||
      place->second.length != block.capacity)
    return std::nullopt;
  return BlockSpace::Taken{slab, place};
}

std::optional<BlockSpace::Taken> SharedPool::State::find_lease(ClientId writer,
                                                               const BlockRef& block) const {
  auto found = find_block(block);
  if (!found || found->place->second.is_committed()) return std::nullopt;
  const PoolClient* const owner = found->slab->space->writer;
  return owner != nullptr && owner->id == writer ? found : std::nullopt;
}

Status SharedPool::State::refuse(std::string_view what, const BlockRef& block,
                                 std::string_view needed) {
  ++counts.refused;
  return invalid_argument("{}: found block {} of slab {} at {}+{}, needs {}", what,
                          block.generation, block.slab, block.offset, block.capacity, needed);
}

Status SharedPool::State::exhaust(std::string_view what, size_t found, size_t needed) {
  ++counts.exhausted;
  return resource_exhausted("shared memory: {} would be {}, needs at most {}", what, found, needed);
}

void SharedPool::State::drop(DividedSlab& slab, Dropped& dropped) {
  slab.space->remove(slab);
  if (slab.space->writer != nullptr) slab.space->writer->slab_bytes -= slab.size();
  by_address.erase(slab.memory.mapping()->data());
  --counts.slabs;
  counts.slab_bytes -= slab.size();
  const auto found = slabs.find(slab.id);
  dropped.push_back(std::move(found->second));
  slabs.erase(found);
}

void SharedPool::State::drop_where(const std::function<bool(DividedSlab&)>& is_dropped,
                                   Dropped& dropped) {
  std::vector<DividedSlab*> chosen;
  for (const auto& [id, slab] : slabs)
    if (slab->taken == 0 && is_dropped(*slab)) chosen.push_back(slab.get());
  for (DividedSlab* slab : chosen) drop(*slab, dropped);
}

void SharedPool::State::free_block(DividedSlab& slab, DividedSlab::Place place, Dropped& dropped) {
  const Block& block = place->second;
  --counts.blocks;
  counts.block_bytes -= block.length;
  if (!block.is_committed()) --counts.uncommitted;
  PoolClient* const writer = slab.space->writer;
  if (writer != nullptr) --writer->blocks;
  slab.space->give_back(slab, place);
  // Once its writer is gone, nobody can lease from this slab again, so it goes with its last block.
  if (writer == nullptr && slab.taken == 0) drop(slab, dropped);
}

void SharedPool::State::free_if_unused(DividedSlab& slab, DividedSlab::Place place,
                                       Dropped& dropped) {
  if (place->second.is_unused()) free_block(slab, place, dropped);
}

std::shared_ptr<BlockSpace>& SharedPool::State::space_of(PoolClient& client, GroupId group) {
  auto& space = client.spaces[group];
  if (space == nullptr) {
    space = std::make_shared<BlockSpace>();
    space->group = group;
    space->writer = &client;
  }
  return space;
}

Status SharedPool::State::add_slab(PoolClient& writer, BlockSpace& space, size_t bytes,
                                   Dropped& dropped) {
  const size_t min = whole_pages(bytes);
  const size_t growth = std::bit_ceil(std::max(space.bytes, options.first_slab_bytes));
  size_t size = std::max(min, whole_pages(std::min(growth, options.slab_bytes)));
  const auto room = [&]() ENGRAM_REQUIRES(mutex) {
    return std::min(options.max_bytes - counts.slab_bytes,
                    options.max_writer_bytes - writer.slab_bytes);
  };
  // Idle slabs are dropped before a lease is refused.
  if (size > room()) drop_where([](const DividedSlab&) { return true; }, dropped);
  // Near the limit, one slab takes all that is left: many small slabs would cost a descriptor each.
  if (size > room()) size = std::max(min, room() / kPage * kPage);
  if (counts.slab_bytes + size > options.max_bytes)
    return exhaust("the pool", counts.slab_bytes + size, options.max_bytes);
  if (writer.slab_bytes + size > options.max_writer_bytes)
    return exhaust(fmt::format("what client {} writes", writer.id), writer.slab_bytes + size,
                   options.max_writer_bytes);
  ENGRAM_ASSIGN_OR_RETURN(Slab memory, Slab::create(size, writer.id == kServerItself));
  const SlabId id = ++last_slab;
  auto slab = std::unique_ptr<DividedSlab>(
      new DividedSlab{id, std::move(memory), writer.spaces[space.group], {}, 0, {}});
  space.add(*slab);
  writer.slab_bytes += size;
  ++counts.slabs;
  counts.slab_bytes += size;
  by_address.emplace(slab->memory.mapping()->data(), slab.get());
  slabs.emplace(id, std::move(slab));
  return {};
}

void SharedPool::State::forget_writer(PoolClient& client, Dropped& dropped) {
  std::vector<BlockSpace::Taken> uncommitted;
  for (const auto& [id, slab] : slabs) {
    if (slab->space->writer != &client) continue;
    for (auto place = slab->blocks.begin(); place != slab->blocks.end(); ++place)
      if (!place->second.is_free() && !place->second.is_committed())
        uncommitted.push_back({slab.get(), place});
  }
  for (const BlockSpace::Taken& block : uncommitted) free_block(*block.slab, block.place, dropped);
  for (auto& [group, space] : client.spaces) space->writer = nullptr;
  drop_where([](const DividedSlab& slab) { return slab.space->writer == nullptr; }, dropped);
}

void SharedPool::State::remove(PoolClient& client, Dropped& dropped) {
  for (auto& [generation, share] : client.shares) {
    --counts.shares;
    share.place->second.shares -= share.count;
    free_if_unused(*share.slab, share.place, dropped);
  }
  forget_writer(client, dropped);
  const ClientId id = client.id;
  if (id != kServerItself) --counts.clients;
  clients.erase(id);
}

}  // namespace engram::server
