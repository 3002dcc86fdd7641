// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/similar_call.h"

#include "server/wire/wire_similar.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

/// They take turns, so that more would wait for longer than anybody does.
constexpr int kMaxSimilarCalls = 64;

/// Notes what somebody asks, and whether they may read all that is compared.
Status audited_question(RpcContext& context, const Identity& who,
                        const ltm::SimilarRequest& request) {
  std::string on = request.entity.to_string();
  Status outcome = who.check(Right::kRead, request.entity);
  for (const ltm::SimilarPart& part : request.with) {
    on += " + " + part.entity.to_string();
    if (outcome.ok()) outcome = who.check(Right::kRead, part.entity);
  }
  return context.audited(who.name(), "similar", on, std::move(outcome));
}

}  // namespace

SimilarCall* SimilarCall::begin(RpcContext& context, const Result<Identity>& who,
                                const v1::SimilarRequest& request, v1::SimilarReply& reply) {
  auto* call = new SimilarCall(context);
  const auto refuse = [call](const Status& status) {
    call->Finish(to_grpc(status));
    return call;
  };
  if (!who.ok()) return refuse(who.status());
  // Before it waits: who may not read must not keep others out.
  auto asked = to_request(request);
  Status may = asked.status();
  if (may.ok()) may = audited_question(context, *who, *asked);
  if (!may.ok()) {
    context.metrics.refused_calls.add();
    return refuse(may);
  }
  if (context.similar_calls.fetch_add(1) >= kMaxSimilarCalls) {
    --context.similar_calls;
    return refuse(resource_exhausted("found {} questions about likeness that wait, needs fewer",
                                     kMaxSimilarCalls));
  }
  context.metrics.similar.add();
  context.comparing.add([call, who = *who, asked = *std::move(asked), &reply] {
    const Status status = call->answer(who, asked, reply);
    --call->context_.similar_calls;
    if (!status.ok()) call->context_.metrics.failed_similar.add();
    call->Finish(to_grpc(status));
  });
  return call;
}

Status SimilarCall::answer(const Identity& who, const ltm::SimilarRequest& request,
                           v1::SimilarReply& reply) {
  // Who asked may have given up while others were answered.
  if (stop_.stop_requested()) return cancelled("nobody waits for the answer");
  ENGRAM_ASSIGN_OR_RETURN(const ltm::SimilarAnswer answer,
                          context_.service.similar(request, who.view(), stop_.get_token()));
  reply = to_message(answer);
  return {};
}

void SimilarCall::OnCancel() {
  stop_.request_stop();
}

void SimilarCall::OnDone() {
  delete this;
}

}  // namespace engram::server
