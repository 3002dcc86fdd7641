// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/commit_stream.h"

#include "server/rpc/wire_event.h"
#include "server/wire/byte_message.h"

namespace engram::server {

namespace {

using Durability = MemoryService::Durability;

Durability needed(const v1::CommitRequest& request, Durability by_default) {
  switch (request.durability()) {
    case v1::MEMORY: return Durability::kMemory;
    case v1::JOURNAL: return Durability::kJournal;
    default: return by_default;
  }
}

}  // namespace

Status CommitStream::on_request(grpc::ByteBuffer& request) {
  v1::CommitRequest message;
  ENGRAM_RETURN_IF_ERROR(read_message(request, message));
  const uint64_t number = message.number();
  const Durability durability = needed(message, context_.durability);
  context_.metrics.commits.add();
  auto admission = commit(message, durability);
  if (!admission.ok()) {
    context_.metrics.refused_commits.add();
    reply(number, admission.status());
    return {};
  }
  if (durability == Durability::kMemory) reply(number, {});
  publish(*admission);
  if (durability == Durability::kMemory) return {};
  promise();
  context_.service.when_stored(
      *admission, [kept = shared_from_this(), this, number](const Status& status) {
        reply(number, status);
        fulfil();
      });
  return {};
}

Result<Admission> CommitStream::commit(v1::CommitRequest& message, Durability durability) {
  ENGRAM_RETURN_IF_ERROR(who_.take_request(steady_now()));
  ENGRAM_ASSIGN_OR_RETURN(WireCommit taken, take_commit(message, {}));
  for (const ltm::EntityUpdate& update : taken.commit.updates)
    ENGRAM_RETURN_IF_ERROR(who_.check(Role::kWrite, update.entity));
  return context_.service.commit(std::move(taken.commit), std::move(taken.encoded), durability);
}

void CommitStream::reply(uint64_t number, const Status& status) {
  v1::CommitReply message;
  message.set_number(number);
  if (!status.ok()) *message.mutable_outcome() = to_outcome(status);
  send(to_bytes(message));
}

void CommitStream::publish(const Admission& admission) {
  context_.hub.publish(admission.snapshots, [](const SharedSnapshot& snapshot) {
    return std::make_shared<WireEvent>(snapshot);
  });
}

}  // namespace engram::server
