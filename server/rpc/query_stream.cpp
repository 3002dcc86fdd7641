// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/query_stream.h"

#include <engram/v1/memory.pb.h>

#include "server/wire/byte_message.h"
#include "server/wire/wire_answer.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

/// The size at which an answer is split into parts. A part with one snapshot may be larger.
constexpr size_t kPartBytes = size_t{1} << 20;

}  // namespace

Status QueryStream::on_request(grpc::ByteBuffer& request) {
  v1::QueryRequest message;
  if (Status status = read_message(request, message); !status.ok()) {
    context_.metrics.broken_requests.add();
    return status;
  }
  const uint64_t number = message.number();
  context_.metrics.queries.add();
  if (Status status = who_.take_request(steady_now()); !status.ok()) {
    context_.metrics.refused_rates.add();
    answer(number, std::move(status));
    return {};
  }
  auto query = ltm::Query::parse(message.query());
  if (!query.ok()) {
    answer(number, query.status());
    return {};
  }
  if (message.engine().empty()) {
    if (auto known = context_.service.query_memory(*query)) {
      answer(number, *std::move(known));
      return {};
    }
  }
  promise();
  {
    const MutexLock lock(asking_);
    asked_.push_back({number, *std::move(query), message.engine()});
  }
  answer_next();
  return {};
}

void QueryStream::answer_next() {
  // Called without the lock, because senders take the two locks in the other order.
  if (!has_room()) return;
  const MutexLock lock(asking_);
  if (is_answering_ || asked_.empty()) return;
  is_answering_ = true;
  context_.work.add([kept = shared_from_this(), this, asked = std::move(asked_.front())] {
    answer(asked.number, context_.service.query(asked.query, asked.engine));
    {
      const MutexLock answered(asking_);
      is_answering_ = false;
    }
    fulfil();
    answer_next();
  });
  asked_.pop_front();
}

void QueryStream::answer(uint64_t number, Result<ltm::Answer> answer) {
  if (answer.ok())
    std::erase_if(answer->entities,
                  [this](const ltm::RecalledEntity& entity) { return !who_.may_read(entity.id); });
  Status status = answer.status();
  if (answer.ok())
    status = write_answer(number, *answer, kPartBytes,
                          [this](const WireBytes& part) { send(part.to_byte_buffer()); });
  if (status.ok()) return;
  context_.metrics.failed_queries.add();
  v1::QueryReply reply;
  reply.set_number(number);
  reply.set_is_last(true);
  *reply.mutable_outcome() = to_outcome(status);
  send(to_bytes(reply));
}

}  // namespace engram::server
