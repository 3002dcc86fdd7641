// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/commit_stream.h"

#include <algorithm>

#include "server/rpc/wire_event.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_block.h"

namespace engram::server {

namespace {

using Durability = memory::MemoryService::Durability;

Durability needed(const v1::CommitRequest& request, Durability by_default) {
  switch (request.durability()) {
    case v1::MEMORY:
      return Durability::kMemory;
    case v1::JOURNAL:
      return Durability::kJournal;
    default:
      return by_default;
  }
}

}  // namespace

Status CommitStream::on_request(grpc::ByteBuffer& request) {
  v1::CommitRequest message;
  if (Status status = read_message(request, message); !status.ok()) {
    context_.metrics.broken_requests.add();
    return status;
  }
  const uint64_t number = message.number();
  const Durability durability = needed(message, context_.durability);
  if (message.updates_size() == 0 && message.lease_bytes() > 0) {
    reply(number, {}, lease(message));
    return {};
  }
  if (message.sensory_entities_size() > 0) {
    reply_with_ring(message);
    return {};
  }
  if (message.has_entry()) {
    // What passes by it is counted where it does.
    const v1::SensoryEntry& entry = message.entry();
    reply(number, context_.rings.pass(who_, sharing_, entry.ring(), entry.written()));
    return {};
  }
  context_.metrics.commits.add();
  SensoryNames sensory;
  auto admission = commit(message, durability, sensory);
  if (!admission.ok()) {
    context_.metrics.refused_commits.add();
    reply(number, admission.status());
    return {};
  }
  const auto leased = lease(message);
  // A single subscriber is notified before the reply, which makes its data younger. With more
  // subscribers the reply goes first, so that the writer does not wait for its readers.
  const bool is_told_first = context_.hub.size() <= 1;
  if (is_told_first) publish(*admission);
  if (durability == Durability::kMemory) reply(number, {}, leased, sensory);
  if (!is_told_first) publish(*admission);
  if (durability == Durability::kMemory) return {};
  promise();
  admission->gone.clear();
  context_.service.when_stored(*admission, [kept = shared_from_this(), this, number, leased,
                                            sensory = std::move(sensory)](const Status& status) {
    reply(number, status, leased, sensory);
    fulfil();
  });
  return {};
}

Result<ltm::Admission> CommitStream::commit(v1::CommitRequest& message, Durability durability,
                                            SensoryNames& sensory) {
  ENGRAM_RETURN_IF_ERROR(context_.take_request(who_, "commit"));
  ENGRAM_ASSIGN_OR_RETURN(WireCommit taken, take(message));
  for (const ltm::EntityUpdate& update : taken.commit.updates)
    ENGRAM_RETURN_IF_ERROR(check(update.entity, update.time));
  // Who asks for a durable commit must not lose it. What a server does by default is for those that
  // do not say.
  if (message.durability() != v1::JOURNAL) {
    sensory = sensory_of(taken.commit);
    if (!sensory.empty())
      ENGRAM_RETURN_IF_ERROR(context_.service.hold(taken.commit, taken.encoded));
    if (!sensory.empty() && taken.commit.updates.empty()) return ltm::Admission();
  }
  return context_.service.commit(std::move(taken.commit), std::move(taken.encoded), durability);
}

CommitStream::SensoryNames CommitStream::sensory_of(const ltm::Commit& commit) const {
  SensoryNames names;
  const auto& sensory = context_.service.sensory();
  if (!sensory) return names;
  for (const ltm::EntityUpdate& update : commit.updates) {
    const memory::SensorySegment* segment = sensory->segment_of(update.entity);
    if (segment == nullptr) continue;
    std::string name = segment->match.to_string();
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

Result<v1::SensoryRing> CommitStream::open_ring(const v1::CommitRequest& message) {
  ENGRAM_RETURN_IF_ERROR(context_.take_request(who_, "commit"));
  if (!context_.sharing || sharing_ == kServerItself)
    return failed_precondition("sensory ring: needs a session of shared memory");
  std::vector<ltm::MemoryId> entities;
  for (const std::string& text : message.sensory_entities()) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(text));
    if (!id.is_entity()) return invalid_argument("found ID '{}', needs that of an entity", text);
    ENGRAM_RETURN_IF_ERROR(context_.service.owns(id));
    // Times are checked with each snapshot that passes.
    ENGRAM_RETURN_IF_ERROR(check(id, system_now()));
    entities.push_back(std::move(id));
  }
  return context_.rings.open(who_, sharing_, entities);
}

void CommitStream::reply_with_ring(const v1::CommitRequest& message) {
  auto opened = open_ring(message);
  v1::CommitReply answer;
  answer.set_number(message.number());
  if (opened.ok())
    *answer.mutable_ring() = *std::move(opened);
  else
    *answer.mutable_outcome() = to_outcome(opened.status());
  send(to_bytes(answer));
}

Status CommitStream::check(const ltm::MemoryId& entity, Time time) {
  Status status = who_.check(Right::kWrite, entity, time);
  if (!context_.audit) return status;
  // What is committed is in the memory itself, so only who begins to write an entity is noted.
  std::string name = entity.to_string();
  if (status.ok() && noted_.contains(name)) return status;
  ENGRAM_RETURN_IF_ERROR(context_.audited(who_.name(), "commit", name, std::move(status)));
  // Those of a stream must not fill the RAM; some are noted again then.
  if (noted_.size() >= kMaxNoted) noted_.clear();
  noted_.insert(std::move(name));
  return {};
}

Result<WireCommit> CommitStream::take(v1::CommitRequest& message) {
  if (!message.has_block()) return take_commit(message, {});
  if (!context_.sharing || sharing_ == kServerItself)
    return failed_precondition("commit: found a block of shared memory, needs a session");
  if (message.updates_size() == 0) return invalid_argument("commit: a block without updates");
  ENGRAM_ASSIGN_OR_RETURN(const auto first, ltm::MemoryId::parse(message.updates(0).entity()));
  const std::string memory = first.names().empty() ? "" : first.names()[0];
  ENGRAM_ASSIGN_OR_RETURN(
      const Buffer block,
      context_.sharing->commit(sharing_, memory, to_block(message.block()), message.block_bytes()));
  ENGRAM_ASSIGN_OR_RETURN(WireCommit taken, take_commit(message, block));
  // A block may hold data of one memory only, because a client that may read the block can read all
  // of it.
  for (const ltm::EntityUpdate& update : taken.commit.updates)
    if (update.entity.names()[0] != memory)
      return invalid_argument("commit: found '{}' in a block of memory '{}'",
                              update.entity.to_string(), memory);
  return taken;
}

std::optional<BlockRef> CommitStream::lease(const v1::CommitRequest& message) {
  if (message.lease_bytes() == 0 || !context_.sharing || sharing_ == kServerItself)
    return std::nullopt;
  // Whoever may read a memory may read each block of it at once, before anything is redacted.
  if (context_.service.may_redact_in(message.lease_memory())) return std::nullopt;
  // An empty lease is not an error: the client then sends plain bytes.
  auto leased = context_.sharing->lease(sharing_, message.lease_memory(), message.lease_bytes());
  return leased.ok() ? std::optional(*leased) : std::nullopt;
}

void CommitStream::reply(uint64_t number, const Status& status,
                         const std::optional<BlockRef>& leased, const SensoryNames& sensory) {
  v1::CommitReply message;
  message.set_number(number);
  if (leased) *message.mutable_block() = to_message(*leased);
  if (!status.ok()) *message.mutable_outcome() = to_outcome(status);
  for (const std::string& segment : sensory) message.add_sensory(segment);
  send(to_bytes(message));
}

void CommitStream::publish(const ltm::Admission& admission) {
  context_.hub.publish(admission.snapshots, [](const ltm::SharedSnapshot& snapshot) {
    return std::make_shared<WireEvent>(snapshot);
  });
}

}  // namespace engram::server
