// SPDX-License-Identifier: Apache-2.0
#include "server/client/robot_servers.h"

#include <algorithm>

#include "ltm/core/log.h"
#include "server/access/endpoint.h"

namespace engram::server {

namespace {

/// The timeout of requests that must not hold up a call: those to the name system, and those that
/// check whether a server is near.
constexpr Duration kShortTimeout = std::chrono::seconds(1);
/// The max number of memories whose last server is remembered.
constexpr size_t kMaxLastHolders = 4096;

bool may_have(const Registration& server, const ltm::Query& query) {
  if (server.memories.empty()) return true;
  return std::ranges::any_of(query.memories(), [&server](const ltm::MemoryQuery& asked) {
    return std::ranges::any_of(server.memories, [&asked](const std::string& memory) {
      return asked.name.matches(memory);
    });
  });
}

}  // namespace

Result<std::unique_ptr<RobotServers>> RobotServers::connect(const std::string& names,
                                                            const ClientOptions& options) {
  ClientOptions calls = options;
  calls.tries_again = false;
  std::unique_ptr<RobotServers> servers(new RobotServers(calls));
  calls.timeout = std::min(calls.timeout, kShortTimeout);
  ENGRAM_ASSIGN_OR_RETURN(servers->names_, NamesClient::connect(names, calls));
  return servers;
}

Status RobotServers::renew(Duration age) {
  const MutexLock one_at_a_time(renewing_);
  if (renewed_ != SteadyTime() && steady_now() - renewed_ < age) return renewal_;
  auto found = names_->resolve("");
  renewed_ = steady_now();
  renewal_ = found.status();
  if (!found.ok()) return renewal_;
  const MutexLock lock(mutex_);
  servers_ = *std::move(found);
  if (last_holders_.size() > kMaxLastHolders) last_holders_.clear();
  for (const Registration& server : servers_)
    for (const std::string& memory : server.memories)
      last_holders_[memory] = {server.server, renewed_};
  return {};
}

void RobotServers::refresh(Duration age) {
  const bool could_ask = [this] {
    const MutexLock lock(renewing_);
    return renewal_.ok();
  }();
  const Status status = renew(age);
  if (!status.ok() && could_ask)
    log::warning("servers are looked for as they were known last: {}", status.to_string());
}

Status RobotServers::absence(std::string_view memory) const {
  {
    const MutexLock lock(renewing_);
    if (!renewal_.ok())
      return unavailable("no server is known to have memory '{}': {}", memory, renewal_.message());
  }
  const std::string last = last_holder(memory);
  if (last.empty()) return not_found("no server has memory '{}'", memory);
  return unavailable("no server has memory '{}'; server '{}', which had it, is gone", memory, last);
}

std::vector<Registration> RobotServers::all() const {
  const MutexLock lock(mutex_);
  return servers_;
}

std::optional<Registration> RobotServers::holder(std::string_view memory) const {
  const MutexLock lock(mutex_);
  const Registration* found = nullptr;
  for (const Registration& server : servers_) {
    if (server.holds(memory)) return server;
    if (server.memories.empty() && found == nullptr) found = &server;
  }
  return found == nullptr ? std::nullopt : std::optional(*found);
}

std::vector<Registration> RobotServers::holders(const ltm::Query& query) const {
  std::vector<Registration> found;
  const MutexLock lock(mutex_);
  for (const Registration& server : servers_)
    if (may_have(server, query)) found.push_back(server);
  return found;
}

std::string RobotServers::last_holder(std::string_view memory) const {
  const MutexLock lock(mutex_);
  const auto found = last_holders_.find(memory);
  return found == last_holders_.end() ? std::string() : found->second.server;
}

std::map<std::string, std::string> RobotServers::gone(const ltm::Query& query) const {
  std::map<std::string, std::string> gone;
  const SteadyTime now = steady_now();
  const MutexLock lock(mutex_);
  for (const auto& known : last_holders_) {
    // Not a structured binding, because clang 14 does not let lambdas capture one.
    const std::string& memory = known.first;
    const LastHolder& last = known.second;
    const auto is_asked = [&](const ltm::MemoryQuery& asked) {
      const bool is_named = asked.name.kind() == ltm::NamePattern::Kind::kName;
      return asked.name.matches(memory) && (is_named || now - last.seen < kGoneAfter);
    };
    const auto has_it = [&](const Registration& server) {
      return server.memories.empty() || server.holds(memory);
    };
    if (std::ranges::any_of(query.memories(), is_asked) && std::ranges::none_of(servers_, has_it))
      gone.emplace(memory, last.server);
  }
  return gone;
}

std::shared_ptr<RobotServers::Connection> RobotServers::connection(const std::string& server) {
  const MutexLock lock(mutex_);
  auto& connection = connections_[server];
  if (!connection) connection = std::make_shared<Connection>();
  return connection;
}

Result<std::shared_ptr<MemoryClient>> RobotServers::client(const Registration& server) {
  const auto connection = this->connection(server.server);
  const MutexLock lock(connection->opening);
  if (connection->client && connection->endpoints == server.endpoints) return connection->client;
  ENGRAM_ASSIGN_OR_RETURN(auto opened, own_client(server, options_));
  connection->client = std::move(opened);
  connection->endpoints = server.endpoints;
  return connection->client;
}

Result<std::unique_ptr<MemoryClient>> RobotServers::own_client(const Registration& server,
                                                               const ClientOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string endpoint, nearest(server));
  return MemoryClient::connect(endpoint, options);
}

void RobotServers::drop(const std::string& server, const MemoryClient* client) {
  const auto connection = this->connection(server);
  const MutexLock lock(connection->opening);
  if (connection->client.get() == client) connection->client.reset();
}

Result<std::string> RobotServers::nearest(const Registration& server) {
  std::vector<std::string> far;
  std::vector<std::string> near;
  for (const std::string& text : server.endpoints) {
    const auto endpoint = Endpoint::parse(text);
    if (!endpoint.ok()) continue;
    if (!endpoint->is_local())
      far.push_back(text);
    else
      near.insert(endpoint->kind() == Endpoint::Kind::kUnix ? near.begin() : near.end(), text);
  }
  for (const std::string& endpoint : near)
    if (answers(endpoint, server.server)) return endpoint;
  if (far.empty())
    return unavailable("server '{}' cannot be reached from this host at {}", server.server,
                       fmt::join(server.endpoints, ", "));
  const MutexLock lock(mutex_);
  return far[tries_[server.server]++ % far.size()];
}

/// Whether this very server answers at the endpoint: another host may have a socket or a port of
/// the same name.
bool RobotServers::answers(const std::string& endpoint, const std::string& server) const {
  ClientOptions asking = options_;
  asking.timeout = std::min(asking.timeout, kShortTimeout);
  const auto client = MemoryClient::connect(endpoint, asking);
  if (!client.ok()) return false;
  const auto info = (*client)->info();
  // A server that refuses this client is accepted here, because the call itself will report the
  // refusal.
  return info.ok() ? info->server == server
                   : info.status().code() == StatusCode::kFailedPrecondition;
}

}  // namespace engram::server
