// SPDX-License-Identifier: Apache-2.0
#include "server/client/memory_client.h"

#include <engram/v1/memory.grpc.pb.h>

#include "ltm/idf/binary.h"
#include "server/client/awaited.h"
#include "server/client/calls.h"
#include "server/client/commit_sender.h"
#include "server/client/messages.h"
#include "server/client/open_channel.h"
#include "server/client/part_queue.h"
#include "server/client/remote_subscription.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_similar.h"
#include "server/wire/wire_snapshot.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

using Async = v1::MemoryServer::StubInterface::async_interface;

Forgotten to_forgotten(const v1::ForgetReply& reply) {
  Forgotten forgotten{{},
                      reply.snapshots(),
                      reply.from_memory(),
                      reply.never_stored(),
                      reply.from_store(),
                      {reply.notes().begin(), reply.notes().end()},
                      reply.erased_json()};
  for (const v1::ForgetReply::Entity& entity : reply.entities())
    forgotten.entities.push_back({entity.entity(), entity.snapshots(),
                                  time_from_ns(entity.first_ns()), time_from_ns(entity.last_ns())});
  return forgotten;
}

}  // namespace

struct MemoryClient::State {
  ClientOptions options;
  std::string endpoint;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::MemoryServer::Stub> stub;
  std::optional<CommitSender> commits;
  std::shared_ptr<Calls<v1::QueryReply>> queries;

  using Answer = Result<ltm::QueryResult>;

  /// Sends a question; `done` is called with the whole answer.
  void ask(v1::QueryRequest request, bool is_ids_only, const std::function<void(Answer)>& done) {
    auto parts = std::make_shared<ltm::QueryResult>(is_ids_only);
    const auto take = [done, parts](v1::QueryReply& reply) {
      const Status taken = take_part(reply, *parts);
      if (!taken.ok()) {
        done(taken);
        return true;
      }
      if (reply.is_last()) done(std::move(*parts));
      return reply.is_last();
    };
    queries->call(
        [&request](uint64_t number) {
          request.set_number(number);
          return to_bytes(request);
        },
        {take, [done](const Status& status) { done(status); }});
  }

  /// The same, waiting for the answer and trying again until the timeout.
  Answer ask(const v1::QueryRequest& request, bool is_ids_only) {
    const SteadyTime deadline = steady_now() + options.timeout;
    Answer answer = retried(last_try(deadline), [&]() -> Answer {
      auto awaited = std::make_shared<Awaited<Answer>>();
      ask(request, is_ids_only, [awaited](Answer one) { awaited->set(std::move(one)); });
      return wait_for(awaited, deadline, [this] { return timed_out(); });
    });
    return answer.ok() ? std::move(answer) : Answer(answer.status().with_context(endpoint));
  }

  /// Asks on a stream of its own, because who takes parts slowly holds it up. Sets `is_visited`
  /// once a part was.
  Status ask_in_parts(v1::QueryRequest request, bool is_ids_only, const Memory::PartVisit& visit,
                      bool& is_visited) {
    const auto parts = std::make_shared<PartQueue>();
    const auto calls = std::make_shared<Calls<v1::QueryReply>>(
        channel, "/engram.v1.MemoryServer/Query", options.token);
    calls->call(
        [&request](uint64_t number) {
          request.set_number(number);
          return to_bytes(request);
        },
        {[parts, is_ids_only](v1::QueryReply& reply) {
           ltm::QueryResult part(is_ids_only);
           const Status taken = take_part(reply, part);
           const bool is_last = reply.is_last() || !taken.ok();
           parts->put(taken.ok() ? Result<ltm::QueryResult>(std::move(part)) : taken, is_last);
           return is_last;
         },
         [parts](const Status& status) { parts->put(status, true); }});
    const auto finish = [&](Status status) {
      // The stream may wait for room.
      parts->close();
      calls->close();
      return status;
    };
    while (true) {
      auto part = parts->take(steady_now() + options.timeout);
      if (!part.ok()) return finish(part.status());
      if (!*part) return finish({});
      is_visited = true;
      if (Status status = visit(**std::move(part)); !status.ok()) return finish(std::move(status));
    }
  }

  /// The time until which a call is retried.
  [[nodiscard]] SteadyTime last_try(SteadyTime deadline) const {
    return options.tries_again ? deadline : steady_now();
  }

  [[nodiscard]] Status timed_out() const {
    return unavailable("server '{}': no answer within {}", endpoint, to_string(options.timeout));
  }

  template <typename Request, typename Reply>
  Status call(void (Async::*method)(grpc::ClientContext*, const Request*, Reply*,
                                    std::function<void(grpc::Status)>),
              const Request& request, Reply& reply) {
    return retried(last_try(steady_now() + options.timeout), [&]() -> Status {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + options.timeout);
      if (!options.token.empty()) context.AddMetadata("authorization", "Bearer " + options.token);
      const grpc::Status status =
          wait_for_call<Async>(stub->async(), method, context, request, reply);
      return status.ok() ? Status() : to_status(status).with_context(endpoint);
    });
  }
};

MemoryClient::MemoryClient(std::shared_ptr<State> state) : state_(std::move(state)) {}

MemoryClient::~MemoryClient() {
  state_->commits->close();
  state_->queries->close();
}

Result<std::unique_ptr<MemoryClient>> MemoryClient::connect(const std::string& endpoint,
                                                            const ClientOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const Endpoint place, Endpoint::parse(endpoint));
  auto state = std::make_shared<State>();
  state->options = options;
  state->endpoint = endpoint;
  ENGRAM_ASSIGN_OR_RETURN(state->channel, open_channel(place, options));
  state->stub = v1::MemoryServer::NewStub(state->channel);
  const bool shares = place.kind() == Endpoint::Kind::kUnix && options.shares_memory;
  state->commits.emplace(options, endpoint, shares, state->channel, *state->stub);
  state->queries = std::make_shared<Calls<v1::QueryReply>>(
      state->channel, "/engram.v1.MemoryServer/Query", options.token);
  return std::unique_ptr<MemoryClient>(new MemoryClient(std::move(state)));
}

void MemoryClient::commit(const ltm::Commit& commit, CommitDurability durability,
                          std::function<void(const Status&)> done) {
  state_->commits->send(commit, durability, done);
}

Result<Loan> MemoryClient::lend(std::span<const ArrayToLend> arrays) {
  return state_->commits->lend(arrays);
}

Status MemoryClient::commit(const ltm::Commit& commit, CommitDurability durability) {
  const SteadyTime deadline = steady_now() + state_->options.timeout;
  const Status status = retried(state_->last_try(deadline), [&]() -> Status {
    auto awaited = std::make_shared<Awaited<Status>>();
    this->commit(commit, durability, [awaited](const Status& done) { awaited->set(done); });
    return wait_for(awaited, deadline, [this] { return state_->timed_out(); });
  });
  return status.ok() ? status : status.with_context(state_->endpoint);
}

void MemoryClient::query(const ltm::Query& query, const std::string& engine,
                         std::function<void(Result<ltm::QueryResult>)> done) {
  state_->ask(to_request(query, engine), query.is_ids_only(), done);
}

Status MemoryClient::query_parts(const ltm::Query& query, const Memory::PartVisit& visit,
                                 const std::string& engine, std::span<const SentContext> contexts) {
  const auto last_try = state_->last_try(steady_now() + state_->options.timeout);
  const v1::QueryRequest request = to_request(query, engine, contexts);
  bool is_visited = false;
  Status refused;  // By the visitor.
  Status failed;   // After a part was visited.
  const auto noting = [&](ltm::QueryResult part) { return refused = visit(std::move(part)); };
  const Status status = retried(last_try, [&]() -> Status {
    Status outcome = state_->ask_in_parts(request, query.is_ids_only(), noting, is_visited);
    if (!is_visited) return outcome;
    // What was visited cannot be taken back, so this is not tried again.
    failed = std::move(outcome);
    return {};
  });
  if (!refused.ok()) return refused;
  if (!failed.ok()) return failed.with_context(state_->endpoint);
  return status.ok() ? status : status.with_context(state_->endpoint);
}

Result<ltm::QueryResult> MemoryClient::query(const ltm::Query& query, const std::string& engine,
                                             std::span<const SentContext> contexts) {
  return state_->ask(to_request(query, engine, contexts), query.is_ids_only());
}

Result<std::optional<SentContext>> MemoryClient::context(const ltm::MemoryId& entity) {
  v1::ContextRequest request;
  request.set_entity(entity.to_string());
  v1::EntityContext reply;
  ENGRAM_RETURN_IF_ERROR(state_->call(&Async::Context, request, reply));
  if (!reply.has_context()) return std::optional<SentContext>();
  return std::optional(SentContext{entity, std::move(*reply.mutable_context())});
}

Result<std::vector<ltm::SnapshotResult>> MemoryClient::predict(const ltm::MemoryId& entity,
                                                               std::span<const Duration> horizons,
                                                               const PredictOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::Query past,
      ltm::Query::create(ltm::Query::of_entity(entity, ltm::select::Latest{}).memories(), true));
  v1::QueryRequest request = to_request(past, options.engine);
  *request.mutable_prediction() = to_request(entity, horizons, options);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, state_->ask(request, false));
  auto predicted = predictions_in(answer, entity, horizons, options);
  if (!predicted.ok()) return predicted.status().with_context(state_->endpoint);
  return predicted;
}

Status MemoryClient::declare(const ltm::MemoryId& segment, const idf::Type& type) {
  v1::DeclareRequest request;
  request.set_segment(segment.to_string());
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(idf::to_data(type)));
  request.set_type(bytes.data(), bytes.size());
  v1::DeclareReply reply;
  return state_->call(&Async::Declare, request, reply);
}

Result<std::vector<std::vector<ltm::EngineRecord>>> MemoryClient::engines(
    const ltm::MemoryId& entity, std::span<const Duration> horizons, std::optional<Time> at) {
  v1::EnginesReply reply;
  ENGRAM_RETURN_IF_ERROR(state_->call(&Async::Engines, to_request(entity, horizons, at), reply));
  return engines_in(reply, entity, horizons, at);
}

Result<ltm::SimilarAnswer> MemoryClient::similar(const ltm::SimilarRequest& request) {
  ENGRAM_ASSIGN_OR_RETURN(const v1::SimilarRequest message, to_message(request));
  v1::SimilarReply reply;
  ENGRAM_RETURN_IF_ERROR(state_->call(&Async::Similar, message, reply));
  return to_answer(reply, request.entity);
}

Result<Forgotten> MemoryClient::forget(const ForgetCall& call) {
  v1::ForgetRequest request;
  for (const std::string& target : call.targets) request.add_targets(target);
  request.set_erase(call.erases);
  request.set_dry_run(call.is_dry_run);
  grpc::ClientContext context;
  if (!state_->options.token.empty())
    context.AddMetadata("authorization", "Bearer " + state_->options.token);
  const std::stop_callback cancels(call.stop, [&context] { context.TryCancel(); });
  const auto reader = state_->stub->Forget(&context, request);
  v1::ForgetReply reply;
  bool is_answered = false;
  while (reader->Read(&reply)) {
    is_answered = reply.is_last();
    if (!is_answered && call.progress)
      call.progress({reply.progress(), reply.done(), reply.total(), "", -1});
    if (is_answered) break;
  }
  const grpc::Status status = reader->Finish();
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED)
    return failed_precondition("server '{}' is of a version that cannot forget", state_->endpoint);
  if (!status.ok()) return to_status(status).with_context(state_->endpoint);
  if (!is_answered) return unavailable("server '{}' did not say what it forgot", state_->endpoint);
  return to_forgotten(reply);
}

Result<ServerInfo> MemoryClient::info() {
  v1::InfoReply reply;
  ENGRAM_RETURN_IF_ERROR(state_->call(&Async::Info, v1::InfoRequest(), reply));
  return ServerInfo{reply.server(),
                    reply.version(),
                    {reply.memories().begin(), reply.memories().end()},
                    reply.figures_json()};
}

Result<std::string> MemoryClient::metrics() {
  v1::MetricsReply reply;
  ENGRAM_RETURN_IF_ERROR(state_->call(&Async::Metrics, v1::MetricsRequest(), reply));
  return reply.text();
}

Result<std::unique_ptr<Subscription>> MemoryClient::subscribe(const SubscriptionOptions& options,
                                                              SubscriptionHandlers handlers) {
  const auto lane = [state = state_]() { return state->commits->lane(); };
  return subscribe_remotely(state_->channel, state_->options, options, std::move(handlers), lane);
}

}  // namespace engram::server
