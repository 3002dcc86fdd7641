// SPDX-License-Identifier: Apache-2.0
#include "server/client/shared_lane.h"

#include <algorithm>

#include "ltm/core/log.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/encode_past_caches.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

/// Rounds up to 8 bytes: readers view arrays in place, so each value must start aligned.
constexpr size_t aligned(size_t bytes) {
  return (bytes + 7) / 8 * 8;
}

}  // namespace

std::shared_ptr<SharedLane> SharedLane::open(v1::MemoryServer::Stub& stub,
                                             const ClientOptions& options) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + options.timeout);
  if (!options.token.empty()) context.AddMetadata("authorization", "Bearer " + options.token);
  v1::InfoRequest request;
  request.set_with_shared_memory(true);
  v1::InfoReply reply;
  if (!stub.Info(&context, request, &reply).ok() || !reply.has_shared_memory()) return nullptr;
  const v1::SharedMemory& offered = reply.shared_memory();
  Ticket ticket{};
  if (offered.ticket().size() != ticket.size()) return nullptr;
  std::ranges::copy(as_bytes(offered.ticket()), ticket.begin());
  auto memory = SharingClient::connect(offered.socket(), ticket, {});
  if (!memory.ok()) {
    log::debug("no shared memory: {}", memory.status().to_string());
    return nullptr;
  }
  auto lane = std::make_shared<SharedLane>();
  lane->session_ = offered.session();
  lane->memory_ = *std::move(memory);
  return lane;
}

std::optional<BlockRef> SharedLane::take_lease(const std::string& memory, size_t bytes) {
  const MutexLock lock(mutex_);
  const auto found = std::ranges::find_if(leases_, [&](const Lease& lease) {
    return lease.memory == memory && lease.block.capacity >= bytes;
  });
  if (found == leases_.end()) return std::nullopt;
  const BlockRef block = found->block;
  leases_.erase(found);
  return block;
}

void SharedLane::keep_lease(const std::string& memory, const BlockRef& block) {
  const MutexLock lock(mutex_);
  if (leases_.size() < kMaxLeases) leases_.push_back({memory, block});
}

size_t bytes_in_block(const ltm::Commit& commit) {
  size_t bytes = 0;
  for (const ltm::EntityUpdate& update : commit.updates)
    for (const ltm::Instance& instance : update.instances)
      bytes += aligned(idf::encoded_size(instance.data));
  return bytes;
}

std::optional<std::string> memory_of(const ltm::Commit& commit) {
  std::optional<std::string> memory;
  for (const ltm::EntityUpdate& update : commit.updates) {
    if (update.entity.names().empty()) return std::nullopt;
    if (memory && *memory != update.entity.names()[0]) return std::nullopt;
    memory = update.entity.names()[0];
  }
  return memory;
}

void describe_in_block(const ltm::Commit& commit, v1::CommitRequest& request) {
  size_t at = 0;
  for (const ltm::EntityUpdate& update : commit.updates) {
    v1::Snapshot& message = *request.add_updates();
    set_head(message, update);
    for (const ltm::Instance& instance : update.instances) {
      v1::Instance& one = *message.add_instances();
      set_metadata(one, instance.metadata);
      const size_t size = idf::encoded_size(instance.data);
      one.mutable_shared()->set_offset(at);
      one.mutable_shared()->set_size(size);
      at += aligned(size);
    }
  }
  request.set_block_bytes(at);
}

Status write_data(const ltm::Commit& commit, std::span<std::byte> out, ReadBack read) {
  size_t at = 0;
  for (const ltm::EntityUpdate& update : commit.updates)
    for (const ltm::Instance& instance : update.instances) {
      const size_t size = idf::encoded_size(instance.data);
      const std::span<std::byte> to = out.subspan(at, size);
      ENGRAM_RETURN_IF_ERROR(read == ReadBack::kSoon ? idf::encode_into(instance.data, to)
                                                     : idf::encode_past_caches(instance.data, to));
      at += aligned(size);
    }
  return {};
}

Status write_in_block(const ltm::Commit& commit, std::span<std::byte> out,
                      v1::CommitRequest& request) {
  describe_in_block(commit, request);
  return write_data(commit, out, ReadBack::kSoon);
}

}  // namespace engram::server
