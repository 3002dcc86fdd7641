// SPDX-License-Identifier: Apache-2.0
#include "server/client/names_client.h"

#include <engram/v1/names.grpc.pb.h>

#include <atomic>
#include <thread>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "server/client/open_channel.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

using AsyncNames = v1::MemoryNameSystem::StubInterface::async_interface;

/// The timeout of a heartbeat. A longer one would delay the next heartbeat.
constexpr auto kHeartbeatTimeout = std::chrono::milliseconds(800);
constexpr auto kTryAgainAfter = std::chrono::milliseconds(200);

v1::ServerRecord to_message(const Registration& registration) {
  v1::ServerRecord message;
  message.set_server(registration.server);
  for (const std::string& memory : registration.memories) message.add_memories(memory);
  for (const std::string& endpoint : registration.endpoints) message.add_endpoints(endpoint);
  message.set_incarnation(registration.incarnation);
  return message;
}

Registration to_registration(const v1::ServerRecord& message) {
  return {message.server(),
          {message.memories().begin(), message.memories().end()},
          {message.endpoints().begin(), message.endpoints().end()},
          message.incarnation()};
}

}  // namespace

struct NamesClient::State {
  std::string endpoint;
  ClientOptions options;
  std::unique_ptr<v1::MemoryNameSystem::Stub> stub;

  void prepare(grpc::ClientContext& context, Duration timeout) const {
    context.set_deadline(std::chrono::system_clock::now() + timeout);
    if (!options.token.empty()) context.AddMetadata("authorization", "Bearer " + options.token);
  }

  template <typename Request, typename Reply>
  Status call(void (AsyncNames::*method)(grpc::ClientContext*, const Request*, Reply*,
                                         std::function<void(grpc::Status)>),
              grpc::ClientContext& context, const Request& request, Reply& reply) const {
    return told(wait_for_call<AsyncNames>(stub->async(), method, context, request, reply));
  }

  [[nodiscard]] Status told(const grpc::Status& status) const {
    return status.ok() ? Status()
                       : to_status(status).with_context(fmt::format("name system '{}'", endpoint));
  }
};

NamesClient::NamesClient(std::unique_ptr<State> state) : state_(std::move(state)) {}
NamesClient::~NamesClient() = default;

Result<std::unique_ptr<NamesClient>> NamesClient::connect(const std::string& endpoint,
                                                          const ClientOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const Endpoint place, Endpoint::parse(endpoint));
  ENGRAM_ASSIGN_OR_RETURN(const auto channel, open_channel(place, options));
  auto state = std::make_unique<State>();
  state->endpoint = endpoint;
  state->options = options;
  state->stub = v1::MemoryNameSystem::NewStub(channel);
  return std::unique_ptr<NamesClient>(new NamesClient(std::move(state)));
}

Result<Duration> NamesClient::add(const Registration& registration) {
  grpc::ClientContext context;
  state_->prepare(context, kHeartbeatTimeout);
  v1::RegisterReply reply;
  ENGRAM_RETURN_IF_ERROR(
      state_->call(&AsyncNames::Register, context, to_message(registration), reply));
  return Duration(reply.heartbeat_interval_ns());
}

Status NamesClient::heartbeat(const std::string& server, uint64_t incarnation) {
  grpc::ClientContext context;
  state_->prepare(context, kHeartbeatTimeout);
  v1::HeartbeatRequest request;
  request.set_server(server);
  request.set_incarnation(incarnation);
  v1::HeartbeatReply reply;
  return state_->call(&AsyncNames::Heartbeat, context, request, reply);
}

Status NamesClient::remove(const std::string& server, uint64_t incarnation) {
  grpc::ClientContext context;
  state_->prepare(context, kHeartbeatTimeout);
  v1::UnregisterRequest request;
  request.set_server(server);
  request.set_incarnation(incarnation);
  v1::UnregisterReply reply;
  return state_->call(&AsyncNames::Unregister, context, request, reply);
}

Result<std::vector<Registration>> NamesClient::resolve(const std::string& memory, Duration wait) {
  grpc::ClientContext context;
  context.set_wait_for_ready(wait > Duration(0));
  state_->prepare(context, state_->options.timeout + wait);
  v1::ResolveRequest request;
  request.set_names(memory);
  request.set_wait_ns(wait.count());
  v1::ResolveReply reply;
  ENGRAM_RETURN_IF_ERROR(state_->call(&AsyncNames::Resolve, context, request, reply));
  std::vector<Registration> servers;
  for (const v1::ServerRecord& server : reply.servers()) servers.push_back(to_registration(server));
  return servers;
}

struct Registrar::State {
  NamesClient& names;
  const Registration registration;
  std::atomic<bool> is_registered{false};
  Mutex mutex;  ///< `wake` needs a mutex; this one guards no member.
  StoppableCondition wake;
  std::jthread thread;

  /// Sends a heartbeat, or registers the server if the name system does not know it. Returns how
  /// long to wait until the next call.
  Duration say() {
    const Status alive = is_registered
                             ? names.heartbeat(registration.server, registration.incarnation)
                             : not_found("not registered yet");
    if (alive.ok()) return interval;
    // A name system that restarted knows no server. One that cannot be reached may have restarted
    // as well, so the server registers again in both cases.
    if (is_registered.exchange(false))
      log::warning("server '{}': {}; registering again", registration.server, alive.message());
    const auto added = names.add(registration);
    if (added.ok()) {
      interval = *added;
      is_registered = true;
      last_error.clear();
      return interval;
    }
    if (added.status().message() != last_error)
      log::warning("server '{}' is not registered: {}", registration.server,
                   added.status().message());
    last_error = added.status().message();
    return kTryAgainAfter;
  }

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const Duration next = say();
      const MutexLock lock(mutex);
      wake.wait_for(mutex, stop, next, [] { return false; });
    }
    if (is_registered && !names.remove(registration.server, registration.incarnation).ok())
      log::debug("server '{}': could not say that it leaves", registration.server);
  }

  Duration interval = std::chrono::seconds(1);
  std::string last_error;
};

Registrar::Registrar(NamesClient& names, Registration registration)
    : state_(new State{names, std::move(registration), false, {}, {}, {}}) {
  State& running = *state_;
  state_->thread = std::jthread([&running](const std::stop_token& stop) { running.run(stop); });
}

Registrar::~Registrar() {
  state_->thread.request_stop();
  state_->thread.join();
}

bool Registrar::is_registered() const {
  return state_->is_registered;
}

}  // namespace engram::server
