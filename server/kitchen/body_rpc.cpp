// SPDX-License-Identifier: Apache-2.0
#include "server/kitchen/body_rpc.h"

#include <engram/v1/kitchen_body.grpc.pb.h>

#include <utility>

#include "server/kitchen/body_messages.h"
#include "server/rpc/rpc_server.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

namespace kitchen = datasets::kitchen;

/// Blocking calls: a thread waits for each client, and there are few.
class BodyService final : public v1::KitchenBody::Service {
 public:
  explicit BodyService(kitchen::LiveBody& body) : body_(body) {}

  grpc::Status Describe(grpc::ServerContext* /*call*/, const v1::BodyDescribeRequest* request,
                        v1::BodyDescription* reply) override {
    *reply = to_message(body_.describe(request->client()));
    return {};
  }

  grpc::Status Wait(grpc::ServerContext* /*call*/, const v1::BodyWaitRequest* request,
                    v1::BodyWaitReply* reply) override {
    const auto states = body_.wait({request->client(), request->bus()}, request->until(), {});
    if (!states.ok()) return to_grpc(states.status());
    for (const kitchen::BodyState& state : *states) *reply->add_states() = to_message(state);
    return {};
  }

  grpc::Status Now(grpc::ServerContext* /*call*/, const v1::BodyNowRequest* /*request*/,
                   v1::BodyState* reply) override {
    if (body_.has_ended()) return to_grpc(cancelled("the robot's body has ended"));
    *reply = to_message(body_.now());
    return {};
  }

  grpc::Status Leave(grpc::ServerContext* /*call*/, const v1::BodyLeaveRequest* request,
                     v1::BodyLeaveReply* /*reply*/) override {
    body_.leave({request->client(), request->bus()});
    return {};
  }

  grpc::Status Draw(grpc::ServerContext* /*call*/, const v1::BodyDrawRequest* request,
                    v1::BodyDrawReply* reply) override {
    const auto picture =
        body_.draw({request->client(), request->bus()}, request->until(), request->committed(), {});
    if (!picture.ok()) return to_grpc(picture.status());
    if (*picture) *reply = to_message(**picture);
    return {};
  }

  grpc::Status Command(grpc::ServerContext* /*call*/, const v1::BodyCommandRequest* request,
                       v1::BodyCommandReply* reply) override {
    const auto command = read_command(*request);
    if (!command.ok()) return to_grpc(command.status());
    const auto length = body_.command(*command);
    if (length.ok()) reply->set_length(*length);
    return to_grpc(length.status());
  }

  grpc::Status Poke(grpc::ServerContext* /*call*/, const v1::BodyPokeRequest* request,
                    v1::BodyPokeReply* reply) override {
    auto words = body_.poke(request->what());
    if (words.ok()) reply->set_words(*std::move(words));
    return to_grpc(words.status());
  }

  grpc::Status Step(grpc::ServerContext* /*call*/, const v1::BodyStepRequest* request,
                    v1::BodyStepReply* /*reply*/) override {
    const auto step = read_step(*request);
    return to_grpc(step.ok() ? body_.step(*step) : step.status());
  }

  grpc::Status Pass(grpc::ServerContext* /*call*/, const v1::BodyPassRequest* request,
                    v1::BodyPassReply* reply) override {
    const auto wish = read_wish(*request);
    if (!wish.ok()) return to_grpc(wish.status());
    const auto sample = body_.pass(*wish, {});
    if (!sample.ok()) return to_grpc(sample.status());
    reply->set_has_passed(sample->has_value());
    reply->set_sample(sample->value_or(0));
    return {};
  }

 private:
  kitchen::LiveBody& body_;
};

}  // namespace

struct BodyServer::State {
  explicit State(kitchen::LiveBody& body) : service(body) {}

  BodyService service;
  std::unique_ptr<RpcServer> server;
};

BodyServer::BodyServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
BodyServer::~BodyServer() = default;

Result<std::unique_ptr<BodyServer>> BodyServer::start(kitchen::LiveBody& body,
                                                      const Endpoint& endpoint) {
  if (endpoint.kind() != Endpoint::Kind::kUnix)
    return invalid_argument("bus '{}': needs a Unix socket, as in unix:/run/user/1000/kitchen.sock",
                            endpoint.to_string());
  auto state = std::make_unique<State>(body);
  RpcServer::Options options;
  options.endpoints = {endpoint};
  ENGRAM_ASSIGN_OR_RETURN(state->server, RpcServer::start(options, {&state->service}));
  return std::unique_ptr<BodyServer>(new BodyServer(std::move(state)));
}

}  // namespace engram::server
