// SPDX-License-Identifier: Apache-2.0
#include "server/robot/robot.h"

#include <unistd.h>

#include <array>
#include <thread>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "server/access/default_endpoint.h"
#include "server/client/names_client.h"
#include "server/robot/host_watch.h"
#include "server/robot/names_server.h"
#include "server/robot/prior_commits.h"

namespace engram::server {

namespace {

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "localhost";
  return name.data();
}

Result<std::string> token_in(const std::filesystem::path& file) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer text, read_file(file));
  std::string token(as_text(text.bytes()));
  token.erase(token.find_last_not_of("\r\n") + 1);
  return token;
}

Result<std::unique_ptr<NamesClient>> names_elsewhere(const NamesConfig& names) {
  ClientOptions options{.ca = names.ca};
  if (!names.token.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.token, token_in(names.token));
  }
  return NamesClient::connect(names.at->to_string(), options);
}

}  // namespace

struct Robot::State {
  RobotConfig config;
  Options robot_options;
  std::unique_ptr<NamesServer> names_server;
  std::unique_ptr<NamesClient> names_client;
  std::shared_ptr<AuditLog> audit;
  std::vector<std::unique_ptr<MemoryServer>> servers;
  std::optional<HostWatch> watch;
  Mutex mutex;  ///< `wake` needs a mutex; this one guards no member.
  StoppableCondition wake;
  std::jthread thread;  ///< Declared last, so that it ends first.

  Status start_names() {
    if (!config.names) return {};
    if (config.names->at) {
      ENGRAM_ASSIGN_OR_RETURN(names_client, names_elsewhere(*config.names));
      return {};
    }
    NamesServer::Options options;
    options.rpc.endpoints = config.names->listen;
    options.rpc.security = config.security;
    options.tokens = config.security.tokens;
    for (const Endpoint& endpoint : options.rpc.endpoints)
      ENGRAM_RETURN_IF_ERROR(prepare_folder(endpoint));
    ENGRAM_ASSIGN_OR_RETURN(names_server, NamesServer::start(options));
    return {};
  }

  /// All memories of the robot, by its name system.
  [[nodiscard]] Result<std::unique_ptr<Memory>> memory_of_robot(
      const std::filesystem::path& token) const {
    ConnectOptions options{.is_name_system = true, .ca = config.names->ca};
    if (!token.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(options.token, token_in(token));
    }
    return Memory::connect(
        names_server ? names_server->endpoints().front() : config.names->at->to_string(), options);
  }

  Status start_server(const ServerConfig& server) {
    const std::string& name = server.options.service.name;
    for (const Endpoint& endpoint : server.options.rpc.endpoints)
      ENGRAM_RETURN_IF_ERROR(prepare_folder(endpoint));
    MemoryServer::Options options = server.options;
    options.audit = audit;
    options.service.erasing = robot_options.erasing;
    // Conditions may look at what other servers have.
    if (options.skills && config.names)
      options.skills->open = [this, token = options.skills->token] {
        return memory_of_robot(token);
      };
    auto started = MemoryServer::start(options, robot_options.loader, names_client.get());
    if (!started.ok()) return started.status().with_context(fmt::format("server '{}'", name));
    servers.push_back(*std::move(started));
    if (const auto store = servers.back()->service().counters().store;
        store && store->lost_frames > 0)
      log::warning(
          "server '{}': {} places in the journal of its store were damaged before; what "
          "was there is lost",
          name, store->lost_frames);
    if (!server.prior.empty()) {
      const auto prior = commit_prior(*servers.back(), server.prior);
      if (!prior.ok()) return prior.status().with_context(fmt::format("server '{}'", name));
      log::info("server '{}': {} entities of prior knowledge, {} of them new or changed", name,
                prior->entities, prior->entities - prior->known);
    }
    // Registered only now, after its prior knowledge: clients that the name system sends here would
    // otherwise miss it.
    if (names_server) return names_server->registry().add(servers.back()->registration()).status();
    return {};
  }

  Status start_watch() {
    HostWatch::Options options;
    options.reader.root = robot_options.host_root;
    options.host = robot_options.host.empty() ? host_name() : robot_options.host;
    std::vector<HostWatch::Watched> watched;
    for (size_t i = 0; i < servers.size(); ++i) {
      const ServerConfig& server = config.servers[i];
      if (server.options.service.store)
        options.reader.disks.push_back(server.options.service.store->store);
      watched.push_back({servers[i].get(), server.options.service.memory.all, server.min_bytes,
                         config.system_state == i});
    }
    ENGRAM_ASSIGN_OR_RETURN(watch, HostWatch::create(options, watched));
    return {};
  }

  /// Sends heartbeats to the name system of this process by direct calls, without a network.
  void keep_registered() {
    if (!names_server) return;
    for (const auto& server : servers) {
      const Registration said = server->registration();
      NameRegistry& registry = names_server->registry();
      auto heard = registry.heartbeat(said.server, said.incarnation);
      if (!heard.ok()) heard = registry.add(said);
      if (!heard.ok()) log::warning("{}", heard.status().message());
    }
  }

  /// Removes a registration. A server that is no longer registered is not an error.
  void let_go(const Registration& said) {
    const Status status = names_server->registry().remove(said.server, said.incarnation);
    if (!status.ok() && status.code() != StatusCode::kNotFound)
      log::warning("{}", status.message());
  }

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      keep_registered();
      watch->look(steady_now());
      const MutexLock lock(mutex);
      wake.wait_for(mutex, stop, robot_options.interval, [] { return false; });
    }
  }

  void stop_thread() {
    thread.request_stop();
    if (thread.joinable()) thread.join();
  }
};

Robot::Robot(std::unique_ptr<State> state) : state_(std::move(state)) {}

Robot::~Robot() {
  for (const StoppedServer& ended : stop())
    if (!ended.status.ok()) log::warning("server '{}': {}", ended.server, ended.status.to_string());
}

Result<std::unique_ptr<Robot>> Robot::start(const RobotConfig& config, Options robot_options) {
  auto state = std::make_unique<State>();
  state->config = config;
  state->robot_options = std::move(robot_options);
  if (!config.audit.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(state->audit, AuditLog::open(config.audit));
  }
  ENGRAM_RETURN_IF_ERROR(state->start_names());
  for (const ServerConfig& server : config.servers)
    ENGRAM_RETURN_IF_ERROR(state->start_server(server));
  // Only now, because the skill memory of one server may look at what others have.
  for (const auto& server : state->servers)
    if (const Status status = server->begin_skills(); !status.ok())
      return status.with_context(
          fmt::format("server '{}': skill memory", server->service().options().name));
  ENGRAM_RETURN_IF_ERROR(state->start_watch());
  State& running = *state;
  state->thread = std::jthread([&running](const std::stop_token& stop) { running.run(stop); });
  return std::unique_ptr<Robot>(new Robot(std::move(state)));
}

std::vector<Robot::ServerSummary> Robot::servers() const {
  std::vector<ServerSummary> all;
  for (const auto& server : state_->servers) {
    const memory::MemoryService::Options& options = server->service().options();
    all.push_back({options.name, options.memories, server->endpoints(),
                   options.store ? options.store->store : std::filesystem::path()});
  }
  return all;
}

std::vector<std::string> Robot::names() const {
  return state_->names_server ? state_->names_server->endpoints() : std::vector<std::string>();
}

std::vector<Robot::StoppedServer> Robot::stop() {
  state_->stop_thread();
  std::vector<StoppedServer> all;
  for (const auto& server : state_->servers) {
    const Registration said = server->registration();
    if (state_->names_server) state_->let_go(said);
    Status status = server->stop();
    all.push_back({said.server, std::move(status), server->service().counters()});
  }
  state_->servers.clear();
  state_->watch.reset();
  state_->names_server.reset();
  state_->audit.reset();
  return all;
}

}  // namespace engram::server
