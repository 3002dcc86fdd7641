// SPDX-License-Identifier: Apache-2.0
#include "server/kitchen/body_client.h"

#include <engram/v1/kitchen_body.grpc.pb.h>

#include <utility>

#include "server/client/open_channel.h"
#include "server/kitchen/body_messages.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

namespace kitchen = datasets::kitchen;

/// A call that takes longer than this found a body that is stuck.
constexpr std::chrono::seconds kBodyTimeout{30};

using Async = v1::KitchenBody::StubInterface::async_interface;

class FarBus final : public kitchen::RobotBus {
 public:
  FarBus(std::string endpoint, std::string client, std::unique_ptr<v1::KitchenBody::Stub> stub)
      : endpoint_(std::move(endpoint)), client_(std::move(client)), stub_(std::move(stub)) {}

  Result<kitchen::BodyDescription> describe() override {
    v1::BodyDescription reply;
    ENGRAM_RETURN_IF_ERROR(call(&Async::Describe, v1::BodyDescribeRequest(), reply));
    return read_description(reply);
  }

  Result<std::vector<kitchen::BodyState>> wait(uint64_t until,
                                               const std::stop_token& stop) override {
    v1::BodyWaitRequest request;
    request.set_client(client_);
    request.set_until(until);
    while (true) {
      if (stop.stop_requested()) return cancelled("the client '{}' stopped", client_);
      v1::BodyWaitReply reply;
      ENGRAM_RETURN_IF_ERROR(call(&Async::Wait, request, reply));
      if (reply.states().empty()) continue;
      std::vector<kitchen::BodyState> states;
      for (const v1::BodyState& one : reply.states()) {
        ENGRAM_ASSIGN_OR_RETURN(kitchen::BodyState state, read_state(one));
        states.push_back(std::move(state));
      }
      return states;
    }
  }

  Result<kitchen::BodyPicture> draw(uint64_t until, uint64_t committed,
                                    const std::stop_token& stop) override {
    v1::BodyDrawRequest request;
    request.set_client(client_);
    request.set_until(until);
    request.set_committed(committed);
    while (true) {
      if (stop.stop_requested()) return cancelled("the client '{}' stopped", client_);
      v1::BodyDrawReply reply;
      ENGRAM_RETURN_IF_ERROR(call(&Async::Draw, request, reply));
      if (reply.is_drawn()) return read_picture(reply);
    }
  }

  Result<double> command(const kitchen::BodyCommand& command) override {
    v1::BodyCommandReply reply;
    ENGRAM_RETURN_IF_ERROR(call(&Async::Command, to_message(command), reply));
    return reply.length();
  }

  Result<std::string> poke(const std::string& what) override {
    v1::BodyPokeRequest request;
    request.set_what(what);
    v1::BodyPokeReply reply;
    ENGRAM_RETURN_IF_ERROR(call(&Async::Poke, request, reply));
    return reply.words();
  }

 private:
  template <typename Request, typename Reply>
  Status call(void (Async::*method)(grpc::ClientContext*, const Request*, Reply*,
                                    std::function<void(grpc::Status)>),
              const Request& request, Reply& reply) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kBodyTimeout);
    const grpc::Status status =
        wait_for_call<Async>(stub_->async(), method, context, request, reply);
    if (status.ok()) return {};
    const Status told = to_status(status);
    if (told.code() != StatusCode::kUnavailable) return told;
    return unavailable("no live kitchen at '{}': {}", endpoint_, told.message());
  }

  std::string endpoint_;
  std::string client_;
  std::unique_ptr<v1::KitchenBody::Stub> stub_;
};

}  // namespace

Result<std::unique_ptr<kitchen::RobotBus>> connect_body(const Endpoint& endpoint,
                                                        const std::string& client) {
  if (endpoint.kind() != Endpoint::Kind::kUnix)
    return invalid_argument("bus '{}': needs a Unix socket", endpoint.to_string());
  ENGRAM_ASSIGN_OR_RETURN(const auto channel, open_channel(endpoint, ClientOptions()));
  std::unique_ptr<kitchen::RobotBus> bus =
      std::make_unique<FarBus>(endpoint.to_string(), client, v1::KitchenBody::NewStub(channel));
  return bus;
}

}  // namespace engram::server
