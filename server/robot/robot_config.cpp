// SPDX-License-Identifier: Apache-2.0
#include "server/robot/robot_config.h"

#include <algorithm>
#include <array>
#include <set>

#include "ltm/core/config.h"
#include "ltm/filter/config_choice.h"
#include "ltm/recording/presets.h"
#include "ltm/recording/recording_config.h"
#include "server/access/default_endpoint.h"
#include "server/robot/working_memory_config.h"

namespace engram::server {

using ltm::Choice;
using ltm::MemoryId;
using ltm::read_choice;

namespace {

constexpr const char* kSystemState = "SystemState";

constexpr DeprecatedWord kMaxHorizonKey{"furthest_prediction", "max_horizon", "0.3"};

constexpr std::array<Choice<ltm::StoreMode>, 3> kModes{
    {{"what-leaves", ltm::StoreMode::kWhatLeaves},
     {"everything", ltm::StoreMode::kEverything},
     {"latest", ltm::StoreMode::kLatest}}};

constexpr std::array<Choice<memory::MemoryService::Durability>, 2> kDurabilities{
    {{"memory", memory::MemoryService::Durability::kMemory},
     {"journal", memory::MemoryService::Durability::kJournal}}};

/// Reads one configuration. It is a class because some keys depend on values elsewhere in the file.
class RobotReader {
 public:
  explicit RobotReader(std::filesystem::path directory) : directory_(std::move(directory)) {}

  Result<RobotConfig> read(const ConfigValue& file) {
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap top, file.map());
    ENGRAM_RETURN_IF_ERROR(read_security(top));
    ENGRAM_RETURN_IF_ERROR(read_names(top));
    ENGRAM_RETURN_IF_ERROR(read_servers(top));
    ENGRAM_RETURN_IF_ERROR(read_system_state(top));
    ENGRAM_RETURN_IF_ERROR(top.finish());
    if (robot_.servers.empty() && (!robot_.names || robot_.names->listen.empty()))
      return file.error("found neither 'servers' nor 'names' that listen, needs one of them");
    return std::move(robot_);
  }

 private:
  Status read_path(ConfigMap& map, std::string_view key, std::filesystem::path& out) const {
    std::string text;
    ENGRAM_RETURN_IF_ERROR(map.read(key, text, &ConfigValue::text));
    if (!text.empty()) out = directory_ / text;
    return {};
  }

  static Status read_endpoints(ConfigMap& map, std::string_view key, std::vector<Endpoint>& out) {
    const auto value = map.find(key);
    if (!value) return {};
    std::vector<ConfigValue> values{*value};
    if (!value->is_text()) {
      ENGRAM_ASSIGN_OR_RETURN(values, value->list());
    }
    for (const ConfigValue& each : values) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string text, each.text());
      auto endpoint = Endpoint::parse(text);
      if (!endpoint.ok()) return each.error(endpoint.status());
      out.push_back(*std::move(endpoint));
    }
    if (out.empty()) return value->error("found an empty list, needs endpoints");
    return {};
  }

  Status read_security(ConfigMap& top) {
    const auto value = top.find("security");
    if (!value) return {};
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
    ListenPolicy::Options& security = robot_.security;
    ENGRAM_RETURN_IF_ERROR(read_path(map, "certificate", security.certificate));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "key", security.key));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "client_ca", security.client_ca));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "tokens", security.tokens));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "audit", robot_.audit));
    return map.finish();
  }

  Status read_names(ConfigMap& top) {
    const auto value = top.find("names");
    if (!value) return {};
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value->map());
    NamesConfig names;
    ENGRAM_RETURN_IF_ERROR(read_endpoints(map, "listen", names.listen));
    std::vector<Endpoint> at;
    ENGRAM_RETURN_IF_ERROR(read_endpoints(map, "at", at));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "token", names.token));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "ca", names.ca));
    ENGRAM_RETURN_IF_ERROR(map.finish());
    if (names.listen.empty() == at.empty() || at.size() > 1)
      return value->error(
          "needs either 'listen', where a name system of this process listens, or 'at', where "
          "another one does");
    if (!at.empty()) names.at = at.front();
    if (at.empty() && (!names.token.empty() || !names.ca.empty()))
      return value->error("'token' and 'ca' are for a name system elsewhere ('at')");
    robot_.names = std::move(names);
    return {};
  }

  Status read_recording(ConfigMap& map, memory::LongTerm::Options& store) const {
    const auto preset = map.find("preset");
    const auto file = map.find("recording");
    if (preset && file) return preset->error("stands beside 'recording', needs one of them");
    if (preset) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string name, preset->text());
      const auto yaml = ltm::recording_preset(name);
      if (!yaml.ok()) return preset->error(yaml.status());
      ENGRAM_ASSIGN_OR_RETURN(store.recording,
                              ltm::parse_recording_config(*yaml, fmt::format("preset '{}'", name)));
    }
    if (!file) return {};
    ENGRAM_ASSIGN_OR_RETURN(const std::string path, file->text());
    auto recording = ltm::read_recording_config(directory_ / path);
    if (!recording.ok()) return file->error(recording.status());
    store.recording = *std::move(recording);
    return {};
  }

  /// Reads the keys that need a store.
  Status read_store(ConfigMap& map, memory::MemoryService::Options& service) const {
    std::filesystem::path path;
    ENGRAM_RETURN_IF_ERROR(read_path(map, "store", path));
    if (path.empty()) {
      for (const std::string_view key : {"recording", "preset", "decoded", "prefer"})
        if (const auto value = map.find(key)) return value->error("needs a 'store' beside it");
      service.memory.mode = ltm::StoreMode::kLatest;
    } else {
      memory::LongTerm::Options& store = service.store.emplace();
      store.store = std::move(path);
      ENGRAM_RETURN_IF_ERROR(read_recording(map, store));
      ENGRAM_RETURN_IF_ERROR(map.read("decoded", store.max_decoded_bytes, &ConfigValue::bytes));
      ENGRAM_RETURN_IF_ERROR(
          read_choice(map, "prefer", store.prefers_latents,
                      std::array<Choice<bool>, 3>{
                          {{"recorded", false}, {"latent", true}, {"latents", true, "latent"}}}));
    }
    ENGRAM_RETURN_IF_ERROR(read_choice(map, "mode", service.memory.mode, kModes));
    if (!service.store && service.memory.mode != ltm::StoreMode::kLatest)
      return map.find("mode")->error("needs a 'store' beside it, or the mode 'latest'");
    return map.read("latest_every", service.memory.store_interval, &ConfigValue::duration);
  }

  Status read_memories(ConfigMap& map, const std::string& server,
                       std::vector<std::string>& memories) {
    const auto value = map.find("memories");
    if (!value) {
      if (robot_.names)
        return map.value().error(
            "has no key 'memories', needs one: the name system tells others which server has "
            "which memory");
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto values, value->list());
    for (const ConfigValue& each : values) {
      ENGRAM_ASSIGN_OR_RETURN(std::string name, each.text());
      if (const auto id = MemoryId::from_names({name}); !id.ok()) return each.error(id.status());
      const auto [known, is_new] = servers_of_memories_.emplace(name, server);
      if (!is_new)
        return each.error(
            fmt::format("memory '{}' is that of server '{}' already", name, known->second));
      memories.push_back(std::move(name));
    }
    if (memories.empty()) return value->error("found an empty list, needs names of memories");
    return {};
  }

  Status read_listen(ConfigMap& map, MemoryServer::Options& options) const {
    std::vector<Endpoint>& endpoints = options.rpc.endpoints;
    ENGRAM_RETURN_IF_ERROR(read_endpoints(map, "listen", endpoints));
    ENGRAM_RETURN_IF_ERROR(read_endpoints(map, "reached_at", options.reached_at));
    if (endpoints.empty()) {
      auto endpoint = default_endpoint(options.service.name);
      if (!endpoint.ok()) return map.value().error(endpoint.status());
      endpoints.push_back(*std::move(endpoint));
    }
    const bool is_anywhere = std::ranges::any_of(endpoints, [](const Endpoint& endpoint) {
      return endpoint.kind() == Endpoint::Kind::kTcp &&
             (endpoint.host() == "0.0.0.0" || endpoint.host() == "::");
    });
    // 0.0.0.0 is every address of this machine and no address for a client elsewhere.
    if (robot_.names && is_anywhere && options.reached_at.empty())
      return map.find("listen")->error(
          "tells nobody which machine this is, needs 'reached_at' for the name system");
    return {};
  }

  Status read_threads(ConfigMap& map, int& threads) const {
    constexpr int64_t kMaxThreads = 64;
    const auto value = map.find("threads");
    if (!value) return {};
    ENGRAM_ASSIGN_OR_RETURN(const int64_t count, value->integer());
    if (count < 1 || count > kMaxThreads)
      return value->error(fmt::format("found {}, needs 1 to {}", count, kMaxThreads));
    threads = static_cast<int>(count);
    return {};
  }

  /// `skills: false`, or a map.
  Status read_skills(ConfigMap& map, std::optional<MemoryServer::Options::Skills>& skills) const {
    const auto value = map.find("skills");
    if (!value) return {};
    if (value->is_text()) {
      ENGRAM_ASSIGN_OR_RETURN(const bool is_wanted, value->boolean());
      if (!is_wanted) skills.reset();
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap options, value->map());
    ENGRAM_RETURN_IF_ERROR(read_path(options, "token", skills->token));
    if (const auto clock = options.find("clock")) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string text, clock->text());
      auto entity = MemoryId::parse(text);
      if (!entity.ok()) return clock->error(entity.status());
      if (!entity->is_entity())
        return clock->error(fmt::format("found '{}', needs an entity", text));
      skills->clock = *std::move(entity);
    }
    return options.finish();
  }

  Result<ServerConfig> read_server(const ConfigValue& value, bool is_only_one) {
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
    ServerConfig server;
    MemoryServer::Options& options = server.options;
    memory::MemoryService::Options& service = options.service;
    if (!is_only_one) {
      ENGRAM_RETURN_IF_ERROR(map.require("name").status());
    }
    ENGRAM_RETURN_IF_ERROR(map.read("name", service.name, &ConfigValue::text));
    if (!names_.insert(service.name).second)
      return map.find("name")->error(fmt::format("there is a server '{}' already", service.name));
    ENGRAM_RETURN_IF_ERROR(read_memories(map, service.name, service.memories));
    ENGRAM_RETURN_IF_ERROR(read_listen(map, options));
    ENGRAM_RETURN_IF_ERROR(read_store(map, service));
    ENGRAM_RETURN_IF_ERROR(read_choice(map, "durability", options.durability, kDurabilities));
    if (options.durability == memory::MemoryService::Durability::kJournal && !service.store)
      return map.find("durability")->error("needs a 'store' beside it");
    ENGRAM_RETURN_IF_ERROR(read_working_memory(map, service.memory, service.sensory, server.min_bytes));
    ENGRAM_RETURN_IF_ERROR(read_path(map, "prior", server.prior));
    ENGRAM_RETURN_IF_ERROR(map.read(kMaxHorizonKey, service.max_horizon, &ConfigValue::duration));
    std::optional<size_t> max_entities;
    ENGRAM_RETURN_IF_ERROR(read_count(map, "max_entities", max_entities));
    service.max_entities = max_entities.value_or(service.max_entities);
    ENGRAM_RETURN_IF_ERROR(read_threads(map, options.threads));
    ENGRAM_RETURN_IF_ERROR(read_skills(map, options.skills));
    ENGRAM_RETURN_IF_ERROR(map.finish());
    if (const Status status = service.validate(); !status.ok()) return value.error(status);
    options.rpc.security = robot_.security;
    options.tokens = robot_.security.tokens;
    return server;
  }

  Status read_servers(ConfigMap& top) {
    const auto value = top.find("servers");
    if (!value) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto values, value->list());
    for (const ConfigValue& each : values) {
      ENGRAM_ASSIGN_OR_RETURN(ServerConfig server, read_server(each, values.size() == 1));
      robot_.servers.push_back(std::move(server));
    }
    return {};
  }

  /// The server that has SystemState if the file does not say: the server of that memory, else one
  /// of any memory, else the first one. With a name system elsewhere there is no such fallback to
  /// the first, because a server of another process may have it.
  [[nodiscard]] std::optional<size_t> usual_system_state() const {
    if (const auto known = servers_of_memories_.find(kSystemState);
        known != servers_of_memories_.end())
      return index_of(known->second);
    for (size_t i = 0; i < robot_.servers.size(); ++i)
      if (robot_.servers[i].options.service.memories.empty()) return i;
    if (robot_.servers.empty() || (robot_.names && robot_.names->at)) return std::nullopt;
    return 0;
  }

  [[nodiscard]] std::optional<size_t> index_of(const std::string& server) const {
    for (size_t i = 0; i < robot_.servers.size(); ++i)
      if (robot_.servers[i].options.service.name == server) return i;
    return std::nullopt;
  }

  Status read_system_state(ConfigMap& top) {
    const auto value = top.find("system_state");
    robot_.system_state = usual_system_state();
    if (value) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string text, value->text());
      if (text == "false") {
        robot_.system_state.reset();
      } else if (text == "true") {
        if (robot_.servers.empty()) return value->error("needs a server that has it");
        if (!robot_.system_state) robot_.system_state = 0;
      } else {
        robot_.system_state = index_of(text);
        if (!robot_.system_state)
          return value->error(
              fmt::format("found '{}', needs true, false or the name of a server", text));
        const auto known = servers_of_memories_.find(kSystemState);
        if (known != servers_of_memories_.end() && known->second != text)
          return value->error(
              fmt::format("memory '{}' is that of server '{}'", kSystemState, known->second));
      }
    }
    if (!robot_.system_state) return {};
    auto& memories = robot_.servers[*robot_.system_state].options.service.memories;
    // A server that lists its memories refuses all others, so it would refuse its own state.
    if (!memories.empty() && std::ranges::find(memories, kSystemState) == memories.end())
      memories.emplace_back(kSystemState);
    return {};
  }

  const std::filesystem::path directory_;
  RobotConfig robot_;
  std::set<std::string> names_;
  std::map<std::string, std::string> servers_of_memories_;
};

}  // namespace

Result<RobotConfig> robot_of_store(const std::filesystem::path& store) {
  ServerConfig server;
  server.options.service.store.emplace().store = store;
  ENGRAM_ASSIGN_OR_RETURN(Endpoint endpoint, default_endpoint(server.options.service.name));
  server.options.rpc.endpoints.push_back(std::move(endpoint));
  RobotConfig robot;
  robot.servers.push_back(std::move(server));
  robot.system_state = 0;
  return robot;
}

Result<RobotConfig> parse_robot_config(std::string_view text, const std::string& name,
                                       const std::filesystem::path& directory) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::parse(text, name));
  return RobotReader(directory).read(file);
}

Result<RobotConfig> read_robot_config(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file, ConfigValue::read_file(path));
  return RobotReader(path.parent_path()).read(file);
}

std::string_view to_string(ltm::StoreMode mode) {
  for (const Choice<ltm::StoreMode>& choice : kModes)
    if (choice.value == mode) return choice.word;
  return "";
}

}  // namespace engram::server
