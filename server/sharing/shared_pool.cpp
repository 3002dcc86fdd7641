// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/shared_pool.h"

#include "ltm/core/mutex.h"
#include "server/sharing/pool_state.h"

namespace engram::server {

namespace {

constexpr size_t kAlignment = 64;

constexpr size_t aligned(size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

Status SharedPool::Options::validate() const {
  if (first_slab_bytes < kPage || first_slab_bytes > slab_bytes)
    return invalid_argument("first_slab_bytes: found {}, needs {} to slab_bytes ({})",
                            first_slab_bytes, kPage, slab_bytes);
  if (slab_bytes > max_bytes)
    return invalid_argument("slab_bytes: found {}, needs at most max_bytes ({})", slab_bytes,
                            max_bytes);
  if (max_bytes > SIZE_MAX / 4)
    return invalid_argument("max_bytes: found {}, needs at most {}", max_bytes, SIZE_MAX / 4);
  if (keep_free < Duration(0))
    return invalid_argument("keep_free: found {}, needs zero or more", to_string(keep_free));
  return {};
}

/// Keeps a block, and its memory, as long as a Buffer views it.
struct SharedPool::View {
  /// Needs the lock of `pool`.
  View(std::shared_ptr<State> pool, const BlockSpace::Taken& taken)
      : state(std::move(pool)), slab(taken.slab), place(taken.place) {
    ++place->second.views;
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
  ~View() {
    Dropped dropped;
    const MutexLock lock(state->mutex);
    --place->second.views;
    state->free_if_unused(*slab, place, dropped);
  }

  static Buffer make(const std::shared_ptr<State>& state, const BlockSpace::Taken& taken,
                     size_t bytes) ENGRAM_REQUIRES(state->mutex) {
    const std::byte* const start = taken.slab->memory.mapping()->data() + taken.place->first;
    return Buffer(std::make_shared<const View>(state, taken), {start, bytes});
  }

  std::shared_ptr<State> state;
  DividedSlab* slab;
  DividedSlab::Place place;
};

SharedPool::SharedPool(std::shared_ptr<State> state) : state_(std::move(state)) {
  state_->clients.emplace(kServerItself, std::make_unique<PoolClient>());
}

SharedPool::~SharedPool() {
  // Slabs that a Buffer views survive the pool.
  Dropped dropped;
  const MutexLock lock(state_->mutex);
  while (!state_->clients.empty()) state_->remove(*state_->clients.begin()->second, dropped);
}

Result<std::unique_ptr<SharedPool>> SharedPool::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return std::unique_ptr<SharedPool>(new SharedPool(std::make_shared<State>(options)));
}

Status SharedPool::add_client(ClientId client) {
  if (client == kServerItself)
    return invalid_argument("client {}: is the server itself, needs another name", client);
  const MutexLock lock(state_->mutex);
  if (state_->find(client) != nullptr)
    return already_exists("client {}: is connected already", client);
  auto added = std::make_unique<PoolClient>();
  added->id = client;
  state_->clients.emplace(client, std::move(added));
  ++state_->counts.clients;
  return {};
}

void SharedPool::remove_client(ClientId client) {
  if (client == kServerItself) return;
  Dropped dropped;
  const MutexLock lock(state_->mutex);
  if (PoolClient* const found = state_->find(client)) state_->remove(*found, dropped);
}

Status SharedPool::grant_read(ClientId client, GroupId group) {
  const MutexLock lock(state_->mutex);
  PoolClient* const found = state_->find(client);
  if (found == nullptr) return failed_precondition("client {}: is not connected", client);
  found->readable.insert(group);
  return {};
}

Result<BlockRef> SharedPool::lease(ClientId writer, GroupId group, size_t bytes) {
  Dropped dropped;
  State& state = *state_;
  const MutexLock lock(state.mutex);
  PoolClient* const client = state.find(writer);
  if (client == nullptr) return failed_precondition("client {}: is not connected", writer);
  if (bytes == 0) return invalid_argument("client {}: a block of no bytes", writer);
  if (bytes > state.options.max_bytes)
    return state.exhaust("a block", bytes, state.options.max_bytes);
  if (client->blocks >= state.options.max_writer_blocks)
    return state.exhaust(fmt::format("the blocks of client {}", writer), client->blocks + 1,
                         state.options.max_writer_blocks);
  const auto& space = state.space_of(*client, group);
  const size_t length = aligned(bytes);
  auto taken = space->take(length, ++state.last_generation);
  if (!taken) {
    ENGRAM_RETURN_IF_ERROR(state.add_slab(*client, *space, length, dropped));
    taken = space->take(length, state.last_generation);
  }
  ++client->blocks;
  ++state.counts.blocks;
  ++state.counts.uncommitted;
  state.counts.block_bytes += length;
  return BlockRef{taken->slab->id, taken->place->first, length, state.last_generation};
}

Result<std::span<std::byte>> SharedPool::writable(const BlockRef& block) {
  const MutexLock lock(state_->mutex);
  const auto found = state_->find_lease(kServerItself, block);
  if (!found) return state_->refuse("writable", block, "one that the server has not committed");
  return found->slab->memory.mapping()->writable().subspan(block.offset, block.capacity);
}

Result<Buffer> SharedPool::commit(ClientId writer, GroupId group, const BlockRef& block,
                                  size_t bytes) {
  const MutexLock lock(state_->mutex);
  const auto found = state_->find_lease(writer, block);
  if (!found || found->slab->space->group != group)
    return state_->refuse("commit", block,
                          fmt::format("one of group {} leased to client {}", group, writer));
  if (bytes == 0 || bytes > block.capacity)
    return state_->refuse("commit", block, fmt::format("{} bytes of it", bytes));
  // Without the seal, another process could still map the slab for writing and change what readers
  // see.
  if (!found->slab->memory.is_sealed())
    return failed_precondition("slab {}: client {} has not mapped it", block.slab, writer);
  found->place->second.bytes = bytes;
  --state_->counts.uncommitted;
  return View::make(state_, *found, bytes);
}

Status SharedPool::abandon(ClientId writer, const BlockRef& block) {
  Dropped dropped;
  const MutexLock lock(state_->mutex);
  const auto found = state_->find_lease(writer, block);
  if (!found)
    return state_->refuse("abandon", block, fmt::format("one leased to client {}", writer));
  state_->free_block(*found->slab, found->place, dropped);
  return {};
}

Result<Buffer> SharedPool::view(const BlockRef& block, size_t bytes) {
  const MutexLock lock(state_->mutex);
  const auto found = state_->find_block(block);
  if (!found || !found->place->second.is_committed())
    return state_->refuse("view", block, "one that was committed");
  if (bytes > found->place->second.bytes)
    return state_->refuse("view", block, fmt::format("{} bytes of it", bytes));
  return View::make(state_, *found, bytes);
}

std::optional<SharedPool::Located> SharedPool::locate(std::span<const std::byte> bytes) const {
  const MutexLock lock(state_->mutex);
  auto after = state_->by_address.upper_bound(bytes.data());
  if (bytes.empty() || after == state_->by_address.begin()) return std::nullopt;
  DividedSlab& slab = *std::prev(after)->second;
  const auto offset = static_cast<uint64_t>(bytes.data() - std::prev(after)->first);
  if (offset >= slab.size()) return std::nullopt;
  const auto place = std::prev(slab.blocks.upper_bound(offset));
  const Block& block = place->second;
  const uint64_t within = offset - place->first;
  if (!block.is_committed() || bytes.size() > block.bytes || within > block.bytes - bytes.size())
    return std::nullopt;
  return Located{{slab.id, place->first, block.length, block.generation}, within};
}

Status SharedPool::share(const BlockRef& block, ClientId reader) {
  const MutexLock lock(state_->mutex);
  const auto found = state_->find_block(block);
  if (!found || !found->place->second.is_committed())
    return state_->refuse("share", block, "one that was committed");
  PoolClient* const client = state_->find(reader);
  if (client == nullptr) return failed_precondition("client {}: is not connected", reader);
  const GroupId group = found->slab->space->group;
  if (!client->readable.contains(group))
    return failed_precondition("client {}: may not read group {}", reader, group);
  const auto known = client->shares.find(block.generation);
  const size_t held = client->shared_bytes + block.capacity;
  if (known == client->shares.end() && held > state_->options.max_reader_bytes)
    return state_->exhaust(fmt::format("what client {} reads", reader), held,
                           state_->options.max_reader_bytes);
  ++found->place->second.shares;
  if (known != client->shares.end()) {
    ++known->second.count;
    return {};
  }
  client->shares.emplace(block.generation, PoolClient::Share{found->slab, found->place, 1});
  client->shared_bytes = held;
  ++state_->counts.shares;
  return {};
}

Status SharedPool::release(ClientId reader, const BlockRef& block, uint64_t count) {
  Dropped dropped;
  const MutexLock lock(state_->mutex);
  PoolClient* const client = state_->find(reader);
  if (client == nullptr) return state_->refuse("release", block, "a client that is connected");
  const auto known = client->shares.find(block.generation);
  const bool has_it = known != client->shares.end() && known->second.slab->id == block.slab &&
                      known->second.place->first == block.offset && count > 0 &&
                      count <= known->second.count;
  if (!has_it)
    return state_->refuse("release", block, fmt::format("{} leases of client {}", count, reader));
  PoolClient::Share& share = known->second;
  share.count -= count;
  share.place->second.shares -= count;
  const PoolClient::Share copy = share;
  if (share.count == 0) {
    client->shared_bytes -= share.place->second.length;
    client->shares.erase(known);
    --state_->counts.shares;
  }
  state_->free_if_unused(*copy.slab, copy.place, dropped);
  return {};
}

Result<SharedPool::OpenedSlab> SharedPool::open_slab(ClientId client, SlabId slab) {
  const MutexLock lock(state_->mutex);
  const PoolClient* const asking = state_->find(client);
  const DividedSlab* const found = state_->find_slab(slab);
  const bool is_writer = asking != nullptr && found != nullptr && found->space->writer == asking;
  const bool is_reader =
      asking != nullptr && found != nullptr && asking->readable.contains(found->space->group);
  if (!is_writer && !is_reader) {
    ++state_->counts.refused;
    // The error is the same whether or not the slab exists, so that a client without a grant learns
    // nothing.
    return not_found("slab {}: there is none that client {} may open", slab, client);
  }
  if (found->memory.is_sealed() == is_writer)
    return failed_precondition("slab {}: its writer {}", slab,
                               is_writer ? "has it already" : "has to map it first");
  ENGRAM_ASSIGN_OR_RETURN(Descriptor memory, found->memory.descriptor());
  return OpenedSlab{std::move(memory), found->size(), is_writer};
}

Status SharedPool::seal(ClientId writer, SlabId slab) {
  const MutexLock lock(state_->mutex);
  DividedSlab* const found = state_->find_slab(slab);
  const PoolClient* const owner = found == nullptr ? nullptr : found->space->writer;
  if (owner == nullptr || owner->id != writer) {
    ++state_->counts.refused;
    return not_found("slab {}: there is none that client {} writes", slab, writer);
  }
  return found->memory.seal();
}

bool SharedPool::has_slab(SlabId slab) const {
  const MutexLock lock(state_->mutex);
  return state_->slabs.contains(slab);
}

void SharedPool::trim(Time now) {
  Dropped dropped;
  const MutexLock lock(state_->mutex);
  const Duration keep = state_->options.keep_free;
  state_->drop_where(
      [&](DividedSlab& slab) {
        if (!slab.free_since) slab.free_since = now;
        return now - *slab.free_since >= keep;
      },
      dropped);
}

PoolCounters SharedPool::counters() const {
  const MutexLock lock(state_->mutex);
  return state_->counts;
}

}  // namespace engram::server
