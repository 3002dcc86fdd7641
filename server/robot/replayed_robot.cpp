// SPDX-License-Identifier: Apache-2.0
#include "server/robot/replayed_robot.h"

#include <algorithm>

#include "ltm/core/log.h"

namespace engram::server {

namespace {

bool has_store(const ServerConfig& server) {
  return server.options.service.store.has_value();
}

/// The index of the server that has SystemState, if any says so.
std::optional<size_t> owner_of(const RobotConfig& config, const std::string& system_state) {
  if (config.system_state) return config.system_state;
  for (size_t i = 0; i < config.servers.size(); ++i)
    if (std::ranges::count(config.servers[i].options.service.memories, system_state) > 0) return i;
  return std::nullopt;
}

/// Makes the server that has SystemState the one that tells of the replay, if it has a store; else
/// the first that has one gets that memory, and nobody else has it. Returns its index.
Result<size_t> give_system_state(RobotConfig& config) {
  const std::string& name = replay_clock_entity().names()[0];
  const auto owner = owner_of(config, name);
  if (owner && has_store(config.servers[*owner])) return *owner;
  if (owner) {
    memory::MemoryService::Options& service = config.servers[*owner].options.service;
    if (std::erase(service.memories, name) > 0 && service.memories.empty())
      return invalid_argument(
          "replay: server '{}' has the memory {} alone and no store, needs one for what the replay "
          "says of itself",
          service.name, name);
  }
  const auto stored = std::ranges::find_if(config.servers, has_store);
  std::vector<std::string>& memories = stored->options.service.memories;
  if (!memories.empty()) memories.push_back(name);
  return static_cast<size_t>(stored - config.servers.begin());
}

}  // namespace

Result<std::shared_ptr<memory::Replay>> replay_robot(RobotConfig& config, ltm::ModelLoader loader,
                                                     const ReplayOptions& options) {
  std::vector<std::filesystem::path> stores;
  for (const ServerConfig& server : config.servers)
    if (server.options.service.store) stores.push_back(server.options.service.store->store);
  if (stores.empty()) return invalid_argument("replay: found no server with a store, needs one");
  ENGRAM_ASSIGN_OR_RETURN(auto replay, memory::Replay::open(stores, std::move(loader), options));
  ENGRAM_ASSIGN_OR_RETURN(const size_t teller, give_system_state(config));
  size_t store = 0;
  for (size_t i = 0; i < config.servers.size(); ++i) {
    ServerConfig& server = config.servers[i];
    server.options.skills.reset();
    memory::MemoryService::Options& service = server.options.service;
    server.prior.clear();
    server.options.durability = memory::MemoryService::Durability::kMemory;
    service.memory.mode = ltm::StoreMode::kLatest;
    if (!service.store) continue;
    service.below = replay->below(store++, i == teller);
    service.redacting = std::move(service.store->recording.rules);
    service.max_answer_bytes = service.store->max_answer_bytes;
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
