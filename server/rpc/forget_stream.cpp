// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/forget_stream.h"

#include <nlohmann/json.hpp>

#include "ltm/forgetting/forget_target.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

constexpr auto kBetweenProgress = std::chrono::milliseconds(200);

/// Each has a thread, and one at a time forgets.
constexpr int kMaxCalls = 16;

/// Checks what a text names letter by letter, whether it exists or not. What patterns and segments
/// find is left out where it may not be erased.
Status check_target(const ltm::ForgetTarget& target, const Identity& who) {
  const ltm::MemoryId everything;
  if (target.query) {
    const auto named = target.query->named_entities();
    if (!named) return who.check_below(Right::kErase, everything);
    for (const ltm::MemoryId& entity : *named)
      ENGRAM_RETURN_IF_ERROR(who.check(Right::kErase, entity));
    return {};
  }
  const ltm::MemoryId& id = *target.id;
  if (!id.has_entity()) return who.check_below(Right::kErase, id);
  return id.time() ? who.check(Right::kErase, id.entity(), *id.time())
                   : who.check(Right::kErase, id.entity());
}

/// Parses one after the other: together they might take much memory.
Status check_targets(const std::vector<std::string>& texts, const Identity& who) {
  for (const std::string& text : texts) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::ForgetTarget target, ltm::ForgetTarget::parse(text));
    ENGRAM_RETURN_IF_ERROR(check_target(target, who));
  }
  return {};
}

/// Notes what somebody asks, and whether they may.
Status audited_request(RpcContext& context, const Identity& who, const v1::ForgetRequest& message,
                       Status outcome) {
  std::string on = fmt::format("{}", fmt::join(message.targets(), " ; "));
  if (message.erase()) on += " (erase)";
  const char* did = message.dry_run() ? "count to forget" : "forget";
  return context.audited(who.name(), did, on, std::move(outcome));
}

v1::ForgetReply reply_of(const memory::ForgetOutcome& outcome) {
  v1::ForgetReply reply;
  reply.set_is_last(true);
  for (const memory::ForgetOutcome::OfEntity& entity : outcome.entities) {
    v1::ForgetReply::Entity& one = *reply.add_entities();
    one.set_entity(entity.entity.to_string());
    one.set_snapshots(entity.snapshots);
    one.set_first_ns(to_ns(entity.first));
    one.set_last_ns(to_ns(entity.last));
  }
  reply.set_snapshots(outcome.snapshots);
  reply.set_from_memory(outcome.from_memory);
  reply.set_never_stored(outcome.never_stored);
  reply.set_from_store(outcome.from_store);
  for (const std::string& note : outcome.notes) reply.add_notes(note);
  if (outcome.erased) {
    nlohmann::ordered_json erased = outcome.erased->to_json();
    erased["report"] = outcome.erased->report;
    reply.set_erased_json(erased.dump());
  }
  return reply;
}

}  // namespace

ForgetStream* ForgetStream::begin(RpcContext& context, const Result<Identity>& who,
                                  const v1::ForgetRequest& message) {
  auto* stream = new ForgetStream(context);
  const auto refuse = [&](const Status& status) {
    stream->Finish(to_grpc(status));
    return stream;
  };
  if (!who.ok()) return refuse(who.status());
  // Who may erase nothing at all costs no thread.
  if (Status status = who->check_below(Right::kErase, ltm::MemoryId()); !status.ok()) {
    context.metrics.refused_calls.add();
    return refuse(audited_request(context, *who, message, std::move(status)));
  }
  if (context.forgettings.fetch_add(1) >= kMaxCalls) {
    --context.forgettings;
    return refuse(resource_exhausted("found {} calls that forget, needs fewer", kMaxCalls));
  }
  stream->thread_ = std::jthread([stream, who = *who, message] {
    auto outcome = stream->forget(who, message);
    --stream->context_.forgettings;
    stream->end(std::move(outcome));
  });
  return stream;
}

Result<memory::ForgetOutcome> ForgetStream::forget(const Identity& who,
                                                   const v1::ForgetRequest& message) {
  memory::ForgetRequest request;
  request.targets = {message.targets().begin(), message.targets().end()};
  ENGRAM_RETURN_IF_ERROR(ltm::check_forget_targets(request.targets));
  if (Status status = audited_request(context_, who, message, check_targets(request.targets, who));
      !status.ok()) {
    context_.metrics.refused_calls.add();
    return status;
  }
  context_.metrics.forgettings.add();
  request.erases = message.erase();
  request.is_dry_run = message.dry_run();
  request.view = who.erasable();
  request.stop = stop_.get_token();
  request.progress = [this](const Progress& progress) { tell(progress); };
  request.on_forgotten = [this](const ltm::ForgetSet& gone) {
    context_.hub.forget([&gone](const ltm::HeldSnapshot& snapshot) {
      const auto times = gone.find(snapshot.entity);
      return times != gone.end() && times->second.contains(snapshot.time);
    });
  };
  return context_.service.forget(std::move(request));
}

void ForgetStream::tell(const Progress& progress) {
  if (steady_now() - told_ < kBetweenProgress) return;
  told_ = steady_now();
  const MutexLock lock(mutex_);
  // A client that does not read is told less.
  if (is_writing_) return;
  written_.set_progress(progress.what);
  written_.set_done(progress.done);
  written_.set_total(progress.total);
  is_writing_ = true;
  StartWrite(&written_);
}

void ForgetStream::end(Result<memory::ForgetOutcome> outcome) {
  const MutexLock lock(mutex_);
  if (outcome.ok()) last_ = reply_of(*outcome);
  ended_ = outcome.status();
  if (!is_writing_) end_call();
}

void ForgetStream::end_call() {
  has_ended_call_ = true;
  if (ended_->ok())
    StartWriteAndFinish(&last_, {}, grpc::Status());
  else
    Finish(to_grpc(*ended_));
}

void ForgetStream::OnWriteDone(bool /*ok*/) {
  const MutexLock lock(mutex_);
  is_writing_ = false;
  if (ended_ && !has_ended_call_) end_call();
}

void ForgetStream::OnCancel() {
  stop_.request_stop();
}

void ForgetStream::OnDone() {
  delete this;
}

}  // namespace engram::server
