// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/sensory_rings.h"

#include "server/rpc/rpc_context.h"
#include "server/rpc/shared_ring.h"
#include "server/wire/wire_block.h"

namespace engram::server {

SensoryRings::~SensoryRings() = default;

Result<v1::SensoryRing> SensoryRings::open(const Identity& who, ClientId client,
                                           std::span<const ltm::MemoryId> entities) {
  const auto& sensory = context_.service.sensory();
  const memory::SensorySegment* segment = nullptr;
  for (const ltm::MemoryId& id : entities) {
    const memory::SensorySegment* found = sensory ? sensory->segment_of(id) : nullptr;
    if (found == nullptr || (segment != nullptr && found != segment))
      return failed_precondition("sensory ring: found '{}', needs entities of one sensory segment",
                                 id.to_string());
    segment = found;
  }
  // One at a time: two streams of a client must not make two rings of a segment.
  const MutexLock lock(mutex_);
  std::shared_ptr<SharedRing> ring;
  size_t count = 0;
  for (auto one = rings_.lower_bound({client, 0});
       one != rings_.end() && one->first.first == client; ++one) {
    ++count;
    if (&one->second->segment() == segment && !one->second->is_closed()) ring = one->second;
  }
  if (!ring) {
    if (count >= kMaxRings)
      return resource_exhausted("sensory ring: found {} rings of this client, needs fewer", count);
    ENGRAM_ASSIGN_OR_RETURN(ring,
                            SharedRing::create(context_, who, client, ++last_ring_, *segment));
    rings_.emplace(Key{client, last_ring_}, ring);
  }
  v1::SensoryRing told;
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<uint32_t> places, ring->places_of(entities));
  for (const uint32_t place : places) told.add_places(place);
  told.set_id(ring->id());
  *told.mutable_entries() = to_message(ring->memory().entries);
  *told.mutable_control() = to_message(ring->memory().control);
  told.set_hold_ns(segment->hold.count());
  return told;
}

Status SensoryRings::pass(const Identity& who, ClientId client, uint64_t ring, uint64_t written) {
  std::shared_ptr<SharedRing> found;
  {
    const MutexLock lock(mutex_);
    const auto known = rings_.find({client, ring});
    if (known != rings_.end()) found = known->second;
  }
  if (found && written > 0) return found->pass_until(written);
  ENGRAM_RETURN_IF_ERROR(context_.take_request(who, "commit"));
  if (!found) return not_found("sensory ring {}: is not of this client", ring);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_new, found->begin());
  if (is_new) context_.service.sensory()->add(found);
  return {};
}

void SensoryRings::end(ClientId client) {
  std::vector<std::shared_ptr<SharedRing>> ended;
  {
    const MutexLock lock(mutex_);
    const auto begin = rings_.lower_bound({client, 0});
    auto end = begin;
    for (; end != rings_.end() && end->first.first == client; ++end) ended.push_back(end->second);
    rings_.erase(begin, end);
  }
  for (const auto& ring : ended) ring->end();
}

}  // namespace engram::server
