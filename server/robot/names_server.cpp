// SPDX-License-Identifier: Apache-2.0
#include "server/robot/names_server.h"

#include "server/access/access_policy.h"
#include "server/rpc/names_rpc.h"

namespace engram::server {

struct NamesServer::State {
  std::unique_ptr<NameRegistry> registry;
  std::unique_ptr<AccessPolicy> access;
  std::unique_ptr<grpc::Service> rpc;
  std::unique_ptr<RpcServer> server;
};

NamesServer::NamesServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

NamesServer::~NamesServer() {
  state_->server->stop(std::chrono::milliseconds(200));
}

Result<std::unique_ptr<NamesServer>> NamesServer::start(const Options& options) {
  auto state = std::make_unique<State>();
  auto access = AccessPolicy::everyone();
  if (!options.tokens.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(access, AccessPolicy::read_file(options.tokens));
  }
  const auto started = static_cast<uint64_t>(to_ns(system_now()));
  ENGRAM_ASSIGN_OR_RETURN(state->registry, NameRegistry::create(options.registry, started));
  state->access = std::make_unique<AccessPolicy>(std::move(access));
  state->rpc = make_names_rpc(*state->registry, *state->access);
  ENGRAM_ASSIGN_OR_RETURN(state->server, RpcServer::start(options.rpc, {state->rpc.get()}));
  return std::unique_ptr<NamesServer>(new NamesServer(std::move(state)));
}

std::vector<std::string> NamesServer::endpoints() const {
  return state_->server->endpoints();
}

NameRegistry& NamesServer::registry() {
  return *state_->registry;
}

}  // namespace engram::server
