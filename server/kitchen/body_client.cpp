// SPDX-License-Identifier: Apache-2.0
#include "server/kitchen/body_client.h"

#include <engram/v1/kitchen_body.grpc.pb.h>

#include <random>
#include <utility>

#include "ltm/core/log.h"
#include "server/client/open_channel.h"
#include "server/kitchen/body_messages.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

namespace kitchen = datasets::kitchen;

/// A call that takes longer than this found a body that is stuck.
constexpr std::chrono::seconds kBodyTimeout{30};

using Async = v1::KitchenBody::StubInterface::async_interface;

/// Calls to the body at an endpoint.
class BodyCalls {
 public:
  static Result<BodyCalls> open(const Endpoint& endpoint) {
    if (endpoint.kind() != Endpoint::Kind::kUnix)
      return invalid_argument("bus '{}': needs a Unix socket", endpoint.to_string());
    ENGRAM_ASSIGN_OR_RETURN(const auto channel, open_channel(endpoint, ClientOptions()));
    return BodyCalls(endpoint.to_string(), v1::KitchenBody::NewStub(channel));
  }

  template <typename Request, typename Reply>
  Status call(void (Async::*method)(grpc::ClientContext*, const Request*, Reply*,
                                    std::function<void(grpc::Status)>),
              const Request& request, Reply& reply) const {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kBodyTimeout);
    const grpc::Status status =
        wait_for_call<Async>(stub_->async(), method, context, request, reply);
    if (status.ok()) return {};
    const Status told = to_status(status);
    if (told.code() != StatusCode::kUnavailable) return told;
    return unavailable("no live kitchen at '{}': {}", endpoint_, told.message());
  }

 private:
  BodyCalls(std::string endpoint, std::unique_ptr<v1::KitchenBody::Stub> stub)
      : endpoint_(std::move(endpoint)), stub_(std::move(stub)) {}

  std::string endpoint_;
  std::unique_ptr<v1::KitchenBody::Stub> stub_;
};

/// What no other process has either, so that several clients of a name are told apart.
uint64_t new_number() {
  std::random_device random;
  return (uint64_t{random()} << 32) | random();
}

class FarBus final : public kitchen::RobotBus {
 public:
  FarBus(BodyCalls calls, std::string client)
      : calls_(std::move(calls)), client_(std::move(client)), number_(new_number()) {}
  FarBus(const FarBus&) = delete;
  FarBus& operator=(const FarBus&) = delete;

  ~FarBus() override {
    if (!has_waited_) return;
    v1::BodyLeaveRequest request;
    request.set_client(client_);
    request.set_bus(number_);
    v1::BodyLeaveReply reply;
    const Status left = calls_.call(&Async::Leave, request, reply);
    // A body that is gone does not wait for anybody.
    if (!left.ok() && left.code() != StatusCode::kUnavailable)
      log::warning("kitchen: the body was not told that a bus left: {}", left.message());
  }

  Result<kitchen::BodyDescription> describe() override {
    v1::BodyDescribeRequest request;
    request.set_client(client_);
    v1::BodyDescription reply;
    ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Describe, request, reply));
    return read_description(reply);
  }

  Result<std::vector<kitchen::BodyState>> wait(uint64_t until,
                                               const std::stop_token& stop) override {
    v1::BodyWaitRequest request;
    request.set_client(client_);
    request.set_until(until);
    request.set_bus(number_);
    has_waited_ = true;
    while (true) {
      if (stop.stop_requested()) return cancelled("the client '{}' stopped", client_);
      v1::BodyWaitReply reply;
      ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Wait, request, reply));
      if (reply.states().empty()) continue;
      std::vector<kitchen::BodyState> states;
      for (const v1::BodyState& one : reply.states()) {
        ENGRAM_ASSIGN_OR_RETURN(kitchen::BodyState state, read_state(one));
        ENGRAM_RETURN_IF_ERROR(
            check_order(state.sample, states.empty() ? until : states.back().sample + 1));
        states.push_back(std::move(state));
      }
      return states;
    }
  }

  Result<kitchen::BodyState> now() override {
    v1::BodyState reply;
    ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Now, v1::BodyNowRequest(), reply));
    return read_state(reply);
  }

  Result<kitchen::BodyPicture> draw(uint64_t until, uint64_t committed,
                                    const std::stop_token& stop) override {
    v1::BodyDrawRequest request;
    request.set_client(client_);
    request.set_until(until);
    request.set_committed(committed);
    request.set_bus(number_);
    has_waited_ = true;
    while (true) {
      if (stop.stop_requested()) return cancelled("the client '{}' stopped", client_);
      v1::BodyDrawReply reply;
      ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Draw, request, reply));
      if (!reply.is_drawn()) continue;
      ENGRAM_ASSIGN_OR_RETURN(kitchen::BodyPicture picture, read_picture(reply));
      ENGRAM_RETURN_IF_ERROR(check_order(picture.sample, until));
      return picture;
    }
  }

  Result<double> command(const kitchen::BodyCommand& command) override {
    v1::BodyCommandReply reply;
    ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Command, to_message(command), reply));
    return reply.length();
  }

  Result<std::string> poke(const std::string& what) override {
    v1::BodyPokeRequest request;
    request.set_what(what);
    v1::BodyPokeReply reply;
    ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Poke, request, reply));
    return reply.words();
  }

 private:
  /// Clients subtract samples from each other.
  static Status check_order(uint64_t sample, uint64_t min) {
    if (sample >= min) return {};
    return invalid_argument("bus: the body told sample {}, needs {} or a later one", sample, min);
  }

  const BodyCalls calls_;
  const std::string client_;
  const uint64_t number_;
  bool has_waited_ = false;
};

class FarSteps final : public kitchen::BodySteps {
 public:
  explicit FarSteps(BodyCalls calls) : calls_(std::move(calls)) {}

  Status tell(kitchen::SkillStep step) override {
    v1::BodyStepReply reply;
    return calls_.call(&Async::Step, to_message(step), reply);
  }

  Result<uint64_t> pass(const kitchen::PassWish& wish, const std::stop_token& stop) override {
    v1::BodyPassReply reply;
    while (!stop.stop_requested()) {
      ENGRAM_RETURN_IF_ERROR(calls_.call(&Async::Pass, to_message(wish), reply));
      if (reply.has_passed()) return read_sample(reply.sample(), "the end of a pass");
    }
    ENGRAM_RETURN_IF_ERROR(
        calls_.call(&Async::Pass, to_message({.id = wish.id, .samples = 0}), reply));
    return cancelled("told to stop");
  }

 private:
  const BodyCalls calls_;
};

}  // namespace

Result<std::unique_ptr<kitchen::RobotBus>> connect_body(const Endpoint& endpoint,
                                                        const std::string& client) {
  ENGRAM_ASSIGN_OR_RETURN(BodyCalls calls, BodyCalls::open(endpoint));
  return std::unique_ptr<kitchen::RobotBus>(std::make_unique<FarBus>(std::move(calls), client));
}

Result<std::unique_ptr<kitchen::BodySteps>> connect_steps(const Endpoint& endpoint) {
  ENGRAM_ASSIGN_OR_RETURN(BodyCalls calls, BodyCalls::open(endpoint));
  return std::unique_ptr<kitchen::BodySteps>(std::make_unique<FarSteps>(std::move(calls)));
}

}  // namespace engram::server
