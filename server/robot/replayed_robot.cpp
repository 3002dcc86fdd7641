// SPDX-License-Identifier: Apache-2.0
#include "server/robot/replayed_robot.h"

#include <algorithm>

#include "ltm/core/log.h"

namespace engram::server {

namespace {

/// The index of the server that has SystemState, or of the first that has a store.
size_t teller_of(const RobotConfig& config) {
  if (config.system_state && config.servers[*config.system_state].options.service.store)
    return *config.system_state;
  const auto stored = std::ranges::find_if(config.servers, [](const ServerConfig& server) {
    return server.options.service.store.has_value();
  });
  return static_cast<size_t>(stored - config.servers.begin());
}

void serve_system_state(memory::MemoryService::Options& service) {
  const std::string& name = replay_clock_entity().names()[0];
  if (!service.memories.empty() &&
      std::ranges::find(service.memories, name) == service.memories.end())
    service.memories.push_back(name);
}

}  // namespace

Result<std::shared_ptr<memory::Replay>> replay_robot(RobotConfig& config, ltm::ModelLoader loader,
                                                     const ReplayOptions& options) {
  std::vector<std::filesystem::path> stores;
  for (const ServerConfig& server : config.servers)
    if (server.options.service.store) stores.push_back(server.options.service.store->store);
  if (stores.empty()) return invalid_argument("replay: found no server with a store, needs one");
  ENGRAM_ASSIGN_OR_RETURN(auto replay, memory::Replay::open(stores, std::move(loader), options));
  const size_t teller = teller_of(config);
  serve_system_state(config.servers[teller].options.service);
  size_t store = 0;
  for (size_t i = 0; i < config.servers.size(); ++i) {
    ServerConfig& server = config.servers[i];
    memory::MemoryService::Options& service = server.options.service;
    server.prior.clear();
    server.options.durability = memory::MemoryService::Durability::kMemory;
    service.memory.mode = ltm::StoreMode::kLatest;
    if (service.store) service.below = replay->below(store++, i == teller);
    service.store.reset();
  }
  config.system_state.reset();
  if (config.names && config.names->at) {
    log::warning("replay: the name system at {} is not told of it; needs --server",
                 config.names->at->to_string());
    config.names.reset();
  }
  return replay;
}

}  // namespace engram::server
