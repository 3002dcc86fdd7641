// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/memory_rpc.h"

#include <engram/v1/memory.grpc.pb.h>

#include "ltm/core/mutex.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/type.h"
#include "server/rpc/caller.h"
#include "server/rpc/commit_stream.h"
#include "server/rpc/figures.h"
#include "server/rpc/forget_stream.h"
#include "server/rpc/provide_stream.h"
#include "server/rpc/query_stream.h"
#include "server/rpc/similar_call.h"
#include "server/rpc/subscribe_stream.h"
#include "server/wire/wire_context.h"
#include "server/wire/wire_snapshot.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

using Bytes = grpc::ByteBuffer;
using ByteReactor = grpc::ServerBidiReactor<Bytes, Bytes>;

using ServiceBase = v1::MemoryServer::WithRawCallbackMethod_Commit<
    v1::MemoryServer::WithRawCallbackMethod_Query<v1::MemoryServer::WithRawCallbackMethod_Subscribe<
        v1::MemoryServer::WithCallbackMethod_Declare<
            v1::MemoryServer::WithCallbackMethod_Info<v1::MemoryServer::WithCallbackMethod_Metrics<
                v1::MemoryServer::WithCallbackMethod_Engines<
                    v1::MemoryServer::WithCallbackMethod_Forget<
                        v1::MemoryServer::WithCallbackMethod_Similar<
                            v1::MemoryServer::WithCallbackMethod_Context<
                                v1::MemoryServer::WithRawCallbackMethod_Provide<
                                    v1::MemoryServer::Service>>>>>>>>>>>;

constexpr int kMaxListedHorizons = 16;

void add_record(const ltm::EngineRecord& record, int64_t horizon_ns, bool is_chosen,
                v1::EnginesReply& reply) {
  v1::EnginesReply::Record& one = *reply.add_records();
  one.set_engine(record.engine);
  one.set_model(record.model);
  one.set_horizon_ns(horizon_ns);
  one.set_predictions(record.predictions);
  *one.mutable_mean() = to_message(record.mean);
  *one.mutable_bound() = to_message(record.bound);
  one.set_is_chosen(is_chosen);
}

/// Ends a stream that was refused.
class RefusedStream final : public ByteReactor {
 public:
  explicit RefusedStream(const grpc::Status& status) { Finish(status); }
  void OnDone() override { delete this; }
};

class MemoryRpc final : public ServiceBase {
 public:
  explicit MemoryRpc(RpcContext& context) : context_(context) {}

  ByteReactor* Commit(grpc::CallbackServerContext* call) override {
    return open<CommitStream>(call);
  }
  ByteReactor* Query(grpc::CallbackServerContext* call) override { return open<QueryStream>(call); }
  ByteReactor* Subscribe(grpc::CallbackServerContext* call) override {
    return open<SubscribeStream>(call);
  }

  ByteReactor* Provide(grpc::CallbackServerContext* call) override {
    return open<ProvideStream>(call);
  }

  grpc::ServerUnaryReactor* Declare(grpc::CallbackServerContext* call,
                                    const v1::DeclareRequest* request,
                                    v1::DeclareReply* /*reply*/) override {
    return finish(call, declare(*call, *request));
  }

  grpc::ServerUnaryReactor* Info(grpc::CallbackServerContext* call, const v1::InfoRequest* request,
                                 v1::InfoReply* reply) override {
    const auto who = let_in(*call);
    if (!who.ok()) return finish(call, who.status());
    const memory::MemoryService::Options& options = context_.service.options();
    reply->set_server(options.name);
    reply->set_version(ENGRAM_VERSION);
    for (const std::string& memory : options.memories) reply->add_memories(memory);
    reply->set_figures_json(figures_json(context_, *who));
    if (request->with_shared_memory() && context_.sharing) {
      auto offered = context_.sharing->offer(*who);
      // A client without shared memory sends plain bytes.
      if (offered.ok()) *reply->mutable_shared_memory() = *std::move(offered);
    }
    return finish(call, {});
  }

  grpc::ServerUnaryReactor* Metrics(grpc::CallbackServerContext* call,
                                    const v1::MetricsRequest* /*request*/,
                                    v1::MetricsReply* reply) override {
    if (const auto who = let_in(*call); !who.ok()) return finish(call, who.status());
    reply->set_text(metrics_text(context_));
    return finish(call, {});
  }

  grpc::ServerUnaryReactor* Engines(grpc::CallbackServerContext* call,
                                    const v1::EnginesRequest* request,
                                    v1::EnginesReply* reply) override {
    // Measuring the engines takes up to seconds, too long for one of gRPC's threads.
    grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
    context_.work.add([this, call, request, reply, reactor] {
      reactor->Finish(to_grpc(engines(*call, *request, *reply)));
    });
    return reactor;
  }

  grpc::ServerWriteReactor<v1::ForgetReply>* Forget(grpc::CallbackServerContext* call,
                                                    const v1::ForgetRequest* request) override {
    return ForgetStream::begin(context_, let_in(*call), *request);
  }

  grpc::ServerUnaryReactor* Similar(grpc::CallbackServerContext* call,
                                    const v1::SimilarRequest* request,
                                    v1::SimilarReply* reply) override {
    return SimilarCall::begin(context_, let_in(*call), *request, *reply);
  }

  grpc::ServerUnaryReactor* Context(grpc::CallbackServerContext* call,
                                    const v1::ContextRequest* request,
                                    v1::EntityContext* reply) override {
    // Values are read for it where no index has them, too long for one of gRPC's threads.
    grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
    context_.work.add([this, call, request, reply, reactor] {
      auto found = entity_context(*call, *request);
      if (found.ok()) *reply = *std::move(found);
      reactor->Finish(to_grpc(found.status()));
    });
    return reactor;
  }

 private:
  Result<v1::EntityContext> entity_context(const grpc::CallbackServerContext& call,
                                           const v1::ContextRequest& request) {
    ENGRAM_ASSIGN_OR_RETURN(Identity who, let_in(call));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, ltm::MemoryId::parse(request.entity()));
    if (!entity.is_entity())
      return invalid_argument("found ID '{}', needs that of an entity", request.entity());
    ENGRAM_RETURN_IF_ERROR(
        context_.audited(who.name(), "context", request.entity(), who.check(Right::kRead, entity)));
    ENGRAM_ASSIGN_OR_RETURN(const auto found, context_.service.context(entity, who.view()));
    return to_message(entity, found);
  }

  Status engines(const grpc::CallbackServerContext& call, const v1::EnginesRequest& request,
                 v1::EnginesReply& reply) {
    ENGRAM_ASSIGN_OR_RETURN(const Identity who, let_in(call));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, ltm::MemoryId::parse(request.entity()));
    if (!entity.is_entity())
      return invalid_argument("found ID '{}', needs that of an entity", request.entity());
    ENGRAM_RETURN_IF_ERROR(context_.audited(who.name(), "engines", request.entity(),
                                            who.check(Right::kModels, entity)));
    if (request.horizons_ns_size() > kMaxListedHorizons)
      return invalid_argument("found {} horizons, needs at most {}", request.horizons_ns_size(),
                              kMaxListedHorizons);
    std::optional<Time> at;
    if (request.has_at_ns()) {
      at = time_from_ns(request.at_ns());
      reply.set_at_ns(request.at_ns());
    }
    for (const int64_t horizon : request.horizons_ns()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto records,
                              context_.service.engines(entity, Duration(horizon), at, who.view()));
      for (const ltm::EngineRecord& record : records)
        add_record(record, horizon, &record == &records.front(), reply);
    }
    return {};
  }

  template <typename Stream>
  ByteReactor* open(grpc::CallbackServerContext* call) {
    auto who = caller(context_.access, *call);
    if (!who.ok()) {
      context_.metrics.refused_streams.add();
      const Status refused = context_.audited("", "connect", call->peer(), who.status());
      return new RefusedStream(grpc::Status(grpc::StatusCode::UNAUTHENTICATED, refused.message()));
    }
    if (Status status = check_room(*who); !status.ok()) {
      context_.metrics.refused_streams.add();
      return new RefusedStream(to_grpc(status));
    }
    ClientId sharing = kServerItself;
    const auto session = call->client_metadata().find("engram-session");
    if (context_.sharing && session != call->client_metadata().end())
      sharing = context_.sharing->find({session->second.data(), session->second.size()});
    auto stream = std::make_shared<Stream>(context_, *std::move(who), sharing);
    stream->begin();
    return stream.get();
  }

  Status check_room(const Identity& who) {
    if (context_.streams >= context_.max_streams)
      return resource_exhausted("found {} open streams, needs fewer", context_.max_streams);
    // Callers without tokens cannot be distinguished, so only the limit of the server applies.
    if (context_.access.is_everyone()) return {};
    const MutexLock lock(context_.counting);
    const auto known = context_.streams_of.find(who.name());
    if (known == context_.streams_of.end() || known->second < context_.max_streams_of_one)
      return {};
    return resource_exhausted("found {} open streams of '{}', needs fewer", known->second,
                              who.name());
  }

  static grpc::ServerUnaryReactor* finish(grpc::CallbackServerContext* call, const Status& status) {
    grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
    reactor->Finish(to_grpc(status));
    return reactor;
  }

  /// Identifies the caller of a unary call and counts the call against its rate.
  Result<Identity> let_in(const grpc::CallbackServerContext& call) {
    auto who = caller(context_.access, call);
    if (!who.ok()) {
      context_.metrics.refused_calls.add();
      return context_.audited("", "connect", call.peer(), who.status());
    }
    if (Status status = who->take_request(steady_now()); !status.ok()) {
      context_.metrics.refused_rates.add();
      return status;
    }
    return who;
  }

  Status declare(const grpc::CallbackServerContext& call, const v1::DeclareRequest& request) {
    ENGRAM_ASSIGN_OR_RETURN(const Identity who, let_in(call));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId segment, ltm::MemoryId::parse(request.segment()));
    if (Status status = context_.audited(who.name(), "declare", request.segment(),
                                         who.check(Right::kWrite, segment));
        !status.ok()) {
      context_.metrics.refused_calls.add();
      return status;
    }
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data data,
                            idf::decode(Buffer::copy(as_bytes(request.type()))));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Type type, idf::type_from_data(data));
    return context_.service.declare(segment, type);
  }

  RpcContext& context_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_memory_rpc(RpcContext& context) {
  return std::make_unique<MemoryRpc>(context);
}

void publish(RpcContext& context, std::span<const ltm::SharedSnapshot> snapshots) {
  context.hub.publish(snapshots, [](const ltm::SharedSnapshot& snapshot) {
    return std::make_shared<WireEvent>(snapshot);
  });
}

}  // namespace engram::server
