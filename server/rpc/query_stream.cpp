// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/query_stream.h"

#include <algorithm>

#include "ltm/core/free_memory.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_answer.h"
#include "server/wire/wire_context.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

/// The size at which an answer is split into parts. A part with one snapshot may be larger.
constexpr size_t kPartBytes = size_t{1} << 20;

/// Larger answers are made in steps of so many bytes, as long as few are not read by the client.
/// Values take several times their bytes before they are written.
constexpr size_t kAtOnceBytes = size_t{4} << 20;
constexpr size_t kStepBytes = size_t{256} << 10;
constexpr size_t kWaitingBytes = size_t{2} << 20;

/// As many as a query may have selectors.
constexpr int kMaxHorizons = 1024;

/// What was predicted of an entity, as an answer to a query of these moments.
ltm::Answer answer_of(const ltm::MemoryId& entity, std::vector<ltm::SnapshotResult> predicted) {
  std::ranges::sort(predicted, {}, &ltm::SnapshotResult::time);
  ltm::RecalledEntity one{entity, {}};
  for (ltm::SnapshotResult& moment : predicted) one.snapshots.push_back({std::move(moment)});
  ltm::Answer answer;
  answer.entities.push_back(std::move(one));
  return answer;
}

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
    answer(number, context_.audited(who_.name(), "query", "", std::move(status)));
    return {};
  }
  if (message.has_prediction())
    on_prediction(message);
  else
    on_query(message);
  return {};
}

void QueryStream::on_query(const v1::QueryRequest& message) {
  auto query = ltm::Query::parse(message.query());
  if (!query.ok()) {
    answer(message.number(), query.status());
    return;
  }
  auto others = to_contexts(message.contexts());
  if (!others.ok()) {
    answer(message.number(), others.status());
    return;
  }
  // What an answer leaves out because it may not be read is not told to who asks.
  if (Status status = context_.audited(who_.name(), "query", message.query(), check_named(*query));
      !status.ok()) {
    answer(message.number(), std::move(status));
    return;
  }
  const bool may_be_quick = message.engine().empty();
  // What sensory memory holds passes ahead of an answer, for which others of this stream need not
  // wait.
  const bool waits = context_.service.may_wait_for_sensory(*query, view_.get());
  if (may_be_quick && !waits) {
    if (auto known = context_.service.query_memory(*query, kAtOnceBytes, view_.get())) {
      answer(message.number(), *std::move(known));
      return;
    }
  }
  auto cursor = std::make_shared<std::optional<ltm::Recall::AnswerCursor>>();
  answer_later(
      {message.number(),
       [this, query = *std::move(query), engine = message.engine(), others = *std::move(others),
        cursor, tries_memory = may_be_quick && waits](bool& is_last) -> Result<ltm::Answer> {
         if (!*cursor && tries_memory) {
           is_last = true;
           if (auto known = context_.service.query_memory(query, kAtOnceBytes, view_.get()))
             return *std::move(known);
         }
         if (!*cursor) {
           ENGRAM_ASSIGN_OR_RETURN(*cursor,
                                   context_.service.begin_query(query, engine, view_, others));
         }
         auto part = context_.service.next_part(**cursor, kStepBytes);
         if (part.ok()) redact(*part);
         is_last = (*cursor)->is_done();
         return part;
       }});
}

/// Takes out what the reader may not see any more, and redacts the images that the reader may not
/// see as they are. Each is looked at alone.
void QueryStream::redact(ltm::Answer& answer) const {
  if (!view_ || answer.is_ids_only) return;
  for (ltm::RecalledEntity& entity : answer.entities) {
    const ltm::Sight sight = view_->of(entity.id);
    if (sight.is_whole()) continue;
    std::erase_if(entity.snapshots, [&](ltm::RecalledSnapshot& snapshot) {
      // A prediction is of a time after all, and only made for who sees all as it is.
      if (snapshot.answer.source == ltm::Source::kPredicted) return !sight.predictions;
      // The token may have expired since the answer was made.
      if (!sight.times.contains(snapshot.answer.time)) return true;
      if (sight.exact.contains(snapshot.answer.time)) return false;
      std::vector<idf::Data*> values;
      for (ltm::InstanceResult& instance : snapshot.answer.instances)
        values.push_back(&instance.data);
      // The bytes in which it came would be sent instead.
      snapshot.held.reset();
      return context_.redactor
          ->redact(entity.id, snapshot.answer.time, values, ltm::RedactionMemory::kNone)
          .is_dropped();
    });
  }
}

/// Checks entities that a query names letter by letter, whether they exist or not.
Status QueryStream::check_named(const ltm::Query& query) const {
  if (!view_) return {};
  for (const ltm::MemoryId& entity : query.named_entities().value_or(std::vector<ltm::MemoryId>{}))
    ENGRAM_RETURN_IF_ERROR(who_.check(Right::kRead, entity));
  return {};
}

void QueryStream::on_prediction(const v1::QueryRequest& message) {
  auto asked = asked_of(message);
  const v1::PredictionRequest& told = message.prediction();
  const std::string on =
      told.entity() + (told.plan().empty() ? "" : fmt::format(", by the plan {}", told.plan()));
  if (Status status = context_.audited(who_.name(), "predict", on, asked.status()); !status.ok()) {
    answer(message.number(), std::move(status));
    return;
  }
  answer_later(
      {message.number(), [this, asked = *std::move(asked)](bool& is_last) -> Result<ltm::Answer> {
         is_last = true;
         const auto& [entity, request] = asked;
         ENGRAM_ASSIGN_OR_RETURN(auto predicted, context_.service.predict(entity, request, view_));
         return answer_of(entity, std::move(predicted));
       }});
}

/// Reads and checks what is to be predicted. The reader needs to be let read the plan too: an
/// answer tells of it.
Result<QueryStream::Predicted> QueryStream::asked_of(const v1::QueryRequest& message) const {
  const v1::PredictionRequest& told = message.prediction();
  Predicted asked;
  const auto checked = [this](const std::string& text, Right needed) -> Result<ltm::MemoryId> {
    ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(text));
    if (!id.is_entity()) return invalid_argument("found ID '{}', needs that of an entity", text);
    ENGRAM_RETURN_IF_ERROR(who_.check(needed, id));
    return id;
  };
  ENGRAM_ASSIGN_OR_RETURN(asked.entity, checked(told.entity(), Right::kModels));
  if (!told.plan().empty()) {
    ENGRAM_ASSIGN_OR_RETURN(asked.request.plan, checked(told.plan(), Right::kRead));
  }
  if (told.horizons_ns_size() > kMaxHorizons)
    return invalid_argument("found {} horizons, needs at most {}", told.horizons_ns_size(),
                            kMaxHorizons);
  for (const int64_t horizon : told.horizons_ns()) asked.request.horizons.emplace_back(horizon);
  if (told.has_at_ns()) asked.request.from = time_from_ns(told.at_ns());
  asked.request.engine = message.engine();
  return asked;
}

void QueryStream::answer_later(Asked asked) {
  promise();
  {
    const MutexLock lock(asking_);
    asked_.push_back(std::move(asked));
  }
  answer_next();
}

void QueryStream::answer_next() {
  // Called without the lock, because senders take the two locks in the other order.
  if (!has_room(kWaitingBytes)) return;
  const MutexLock lock(asking_);
  if (is_answering_ || asked_.empty()) return;
  is_answering_ = true;
  context_.work.add([kept = shared_from_this(), this, asked = std::move(asked_.front())]() mutable {
    bool is_last = true;
    auto part = asked.next_part(is_last);
    is_last = is_last || !part.ok();
    answer(asked.number, std::move(part), is_last);
    // What a large answer took would stay with this process otherwise.
    if (is_last && asked.parts > 0) give_back_memory();
    ++asked.parts;
    {
      const MutexLock answered(asking_);
      is_answering_ = false;
      if (!is_last) asked_.push_front(std::move(asked));
    }
    if (is_last) fulfil();
    answer_next();
  });
  asked_.pop_front();
}

void QueryStream::answer(uint64_t number, Result<ltm::Answer> answer, bool is_last) {
  Status status = answer.status();
  if (answer.ok())
    status = write_answer(number, *answer, kPartBytes, is_last,
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
