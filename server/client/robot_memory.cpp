// SPDX-License-Identifier: Apache-2.0
#include "server/client/robot_memory.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "server/client/robot_servers.h"
#include "server/client/robot_subscription.h"
#include "server/client/robot_waits.h"

namespace engram::server {

namespace {

std::string told_by(const ServerOutcome& outcome) {
  return outcome.server.empty()
             ? outcome.status.message()
             : fmt::format("server '{}': {}", outcome.server, outcome.status.message());
}

/// Joins all failures into one status, with the code of the first failure.
Status joined(const std::vector<ServerOutcome>& outcomes) {
  std::vector<std::string> messages;
  std::optional<StatusCode> code;
  for (const ServerOutcome& outcome : outcomes) {
    if (outcome.status.ok()) continue;
    if (!code) code = outcome.status.code();
    messages.push_back(told_by(outcome));
  }
  return code ? Status(*code, fmt::format("{}", fmt::join(messages, "; "))) : Status();
}

using Updates = std::vector<const ltm::EntityUpdate*>;

/// The part of a commit that goes to one server.
struct CommitPart {
  Registration server;
  Updates updates;
};

/// Keyed by the server's name; the empty name holds updates of memories that no server has.
using CommitParts = std::map<std::string, CommitPart>;

/// Asks servers and returns an answer of each. An error ends the whole query.
using AskServers = std::function<Result<std::vector<Result<ltm::QueryResult>>>(
    std::span<const Registration* const>)>;

/// A query to several servers, with the answers received so far.
struct Asking {
  std::map<std::string, Registration> servers;  ///< All servers that the query concerns.
  std::map<std::string, Result<ltm::QueryResult>> answers;

  /// Whether the server still has to be asked, or asked again.
  [[nodiscard]] bool is_open(const std::string& server) const {
    const auto found = answers.find(server);
    return found == answers.end() || is_lost(found->second.status());
  }
};

}  // namespace

struct RobotMemory::State {
  std::unique_ptr<RobotServers> servers;

  [[nodiscard]] SteadyTime deadline() const { return steady_now() + servers->options().timeout; }

  /// Renews the list of servers unless the list names the server of each memory in the query. A
  /// name system that knows no server has just started, so the client waits for it to learn some.
  Status renew_servers(const ltm::Query& query, Backoff& backoff) {
    bool is_known = true;
    for (const ltm::MemoryQuery& memory : query.memories())
      is_known = is_known && memory.name.kind() == ltm::NamePattern::Kind::kName &&
                 servers->holder(memory.name.text()).has_value();
    for (Status status; !is_known;) {
      status = servers->renew(RobotServers::kFreshFor);
      if (!servers->all().empty()) break;
      if (status.ok()) status = unavailable("the name system knows no server");
      if (!backoff.wait()) return status;
    }
    return {};
  }

  // Commits.

  /// Distributes updates to servers; updates of memories that no server has go to "".
  [[nodiscard]] CommitParts split(const Updates& updates) const {
    CommitParts parts;
    for (const ltm::EntityUpdate* update : updates) {
      const auto holder = servers->holder(update->entity.names()[0]);
      CommitPart& part = parts[holder ? holder->server : std::string()];
      if (holder) part.server = *holder;
      part.updates.push_back(update);
    }
    return parts;
  }

  [[nodiscard]] Status nobody_has(const CommitPart& part) const {
    return servers->absence(part.updates[0]->entity.names()[0]);
  }

  /// Sends all parts at once and waits for all replies until `deadline`.
  std::vector<ServerOutcome> send(const CommitParts& parts, CommitDurability durability,
                                  SteadyTime deadline) {
    const auto pending = std::make_shared<PendingReplies>(
        parts.size(), unavailable("no answer within {}", to_string(servers->options().timeout)));
    std::vector<std::shared_ptr<MemoryClient>> clients(parts.size());
    size_t index = 0;
    for (const auto& [server, part] : parts) {
      const size_t at = index++;
      if (server.empty()) {
        pending->set(at, nobody_has(part));
        continue;
      }
      auto client = servers->client(part.server);
      if (!client.ok()) {
        pending->set(at, client.status());
        continue;
      }
      clients[at] = *std::move(client);
      ltm::Commit commit;
      for (const ltm::EntityUpdate* update : part.updates) commit.updates.push_back(*update);
      clients[at]->commit(commit, durability,
                          [pending, at](const Status& status) { pending->set(at, status); });
    }
    // No lock is held from here on: drop() may wait for a connection that is being opened, while
    // late replies need the lock.
    const std::vector<Status> statuses = pending->wait(deadline);
    std::vector<ServerOutcome> outcomes;
    index = 0;
    for (const auto& [server, part] : parts) {
      const Status& status = statuses[index];
      outcomes.push_back({server, status});
      if (is_lost(status)) servers->drop(server, clients[index].get());
      ++index;
    }
    return outcomes;
  }

  Status commit(const ltm::Commit& commit, CommitDurability durability,
                std::vector<ServerOutcome>& outcomes) {
    ENGRAM_RETURN_IF_ERROR(commit.check());
    const SteadyTime deadline = this->deadline();
    Backoff backoff(deadline);
    Updates rest;
    for (const ltm::EntityUpdate& update : commit.updates) rest.push_back(&update);
    for (;;) {
      CommitParts parts = split(rest);
      if (parts.contains({})) {
        servers->refresh(RobotServers::kFreshFor);
        parts = split(rest);
      }
      rest.clear();
      std::vector<ServerOutcome> failed;
      for (ServerOutcome& outcome : send(parts, durability, deadline)) {
        // A server that no longer has the memory may have handed it to another server.
        if (!is_lost(outcome.status) && outcome.status.code() != StatusCode::kNotFound) {
          outcomes.push_back(std::move(outcome));
          continue;
        }
        const Updates& again = parts.at(outcome.server).updates;
        rest.insert(rest.end(), again.begin(), again.end());
        failed.push_back(std::move(outcome));
      }
      if (!failed.empty() && backoff.wait()) {
        servers->refresh(kFirstWait);
        continue;
      }
      outcomes.insert(outcomes.end(), failed.begin(), failed.end());
      return joined(outcomes);
    }
  }

  /// Calls `work` with the server of a memory; repeats it if the server is gone or no longer has
  /// the memory.
  template <typename Work>
  Status at_holder(const std::string& memory, const Work& work) {
    Backoff backoff(deadline());
    for (;;) {
      auto holder = servers->holder(memory);
      if (!holder) {
        servers->refresh(RobotServers::kFreshFor);
        holder = servers->holder(memory);
      }
      Status status;
      if (!holder) {
        status = servers->absence(memory);
      } else {
        auto client = servers->client(*holder);
        status = client.ok() ? work(**client) : client.status();
        if (is_lost(status) && client.ok()) servers->drop(holder->server, client->get());
      }
      const bool is_again = is_lost(status) || status.code() == StatusCode::kNotFound;
      if (!is_again || !backoff.wait()) return status;
      servers->refresh(kFirstWait);
    }
  }

  // Queries.

  /// Updates the servers that the query concerns. A server that has disappeared remains in the list
  /// unless other servers now have its memories, so that its missing answer is not overlooked.
  void find_servers(const ltm::Query& query, Asking& asking) const {
    std::map<std::string, Registration> found;
    for (Registration& server : servers->holders(query)) {
      const std::string name = server.server;
      found.emplace(name, std::move(server));
    }
    for (auto& [name, server] : asking.servers) {
      const auto is_elsewhere = [this](const std::string& memory) {
        return servers->holder(memory).has_value();
      };
      if (found.contains(name) || std::ranges::all_of(server.memories, is_elsewhere)) continue;
      found.emplace(name, std::move(server));
    }
    asking.servers = std::move(found);
  }

  /// `work` asks one server.
  template <typename Work>
  Result<ltm::QueryResult> ask(const Registration& server, const Work& work) {
    ENGRAM_ASSIGN_OR_RETURN(const auto client, servers->client(server));
    Result<ltm::QueryResult> answer = work(*client);
    if (is_lost(answer.status())) servers->drop(server.server, client.get());
    return answer;
  }

  [[nodiscard]] static Status ask_open(const AskServers& ask, Asking& asking) {
    std::vector<const Registration*> open;
    for (const auto& [name, server] : asking.servers)
      if (asking.is_open(name)) open.push_back(&server);
    ENGRAM_ASSIGN_OR_RETURN(auto answers, ask(open));
    for (size_t i = 0; i < open.size(); ++i)
      asking.answers.insert_or_assign(open[i]->server, std::move(answers[i]));
    return {};
  }

  /// Of entities that conditions name and that another server has than one that is asked: places
  /// and context, which the servers do not tell each other. One that nobody has is left to who
  /// answers.
  Result<std::vector<SentContext>> contexts_of_others(const ltm::Query& query,
                                                      std::span<const Registration* const> asked) {
    std::vector<SentContext> contexts;
    for (const ltm::MemoryId& entity : query.condition_entities()) {
      auto holder = servers->holder(entity.names()[0]);
      if (!holder) {
        servers->refresh(RobotServers::kFreshFor);
        holder = servers->holder(entity.names()[0]);
      }
      if (!holder || std::ranges::all_of(asked, [&holder](const Registration* one) {
            return one->server == holder->server;
          }))
        continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto client, servers->client(*holder));
      auto context = client->context(entity);
      if (is_lost(context.status())) servers->drop(holder->server, client.get());
      if (!context.ok()) return context.status();
      if (*context) contexts.push_back(**std::move(context));
    }
    return contexts;
  }

  /// Asks all of them at once for whole answers.
  AskServers asks_whole(const ltm::Query& query, const std::string& engine) {
    return [this, &query, &engine](std::span<const Registration* const> open)
               -> Result<std::vector<Result<ltm::QueryResult>>> {
      ENGRAM_ASSIGN_OR_RETURN(const auto contexts, contexts_of_others(query, open));
      std::vector<Result<ltm::QueryResult>> answers(open.size(), cancelled("not asked"));
      at_once(open.size(), [&](size_t i) {
        answers[i] = ask(
            *open[i], [&](MemoryClient& client) { return client.query(query, engine, contexts); });
      });
      return answers;
    };
  }

  /// Asks one after the other, visits the parts of their answers, and returns empty ones. After the
  /// first part an error ends the query, because a server that is asked again would begin anew.
  AskServers asks_in_parts(const ltm::Query& query, const std::string& engine,
                           const Memory::PartVisit& visit) {
    return [this, &query, &engine, &visit](std::span<const Registration* const> open)
               -> Result<std::vector<Result<ltm::QueryResult>>> {
      ENGRAM_ASSIGN_OR_RETURN(const auto contexts, contexts_of_others(query, open));
      std::vector<Result<ltm::QueryResult>> answers;
      for (const Registration* server : open) {
        bool is_visited = false;
        const auto noting = [&](ltm::QueryResult part) {
          is_visited = true;
          return visit(std::move(part));
        };
        answers.push_back(ask(*server, [&](MemoryClient& client) -> Result<ltm::QueryResult> {
          ENGRAM_RETURN_IF_ERROR(client.query_parts(query, noting, engine, contexts));
          return ltm::QueryResult(query.is_ids_only());
        }));
        if (is_visited) ENGRAM_RETURN_IF_ERROR(answers.back().status());
      }
      return answers;
    };
  }

  /// Asks until all servers have answered or the time is over. Unless `is_patient`, servers that
  /// cannot be reached are tried only once more.
  Result<RobotAnswer> query(const ltm::Query& query, const AskServers& ask, bool is_patient) {
    Backoff backoff(deadline());
    ENGRAM_RETURN_IF_ERROR(renew_servers(query, backoff));
    Asking asking;
    for (int round = 0;; ++round) {
      const std::vector<Registration> before = servers->all();
      find_servers(query, asking);
      ENGRAM_RETURN_IF_ERROR(ask_open(ask, asking));
      bool is_any_open = !nobody_has(query).empty();
      bool has_answer = false;
      for (const auto& [name, server] : asking.servers) {
        is_any_open = is_any_open || asking.is_open(name);
        has_answer = has_answer || asking.answers.at(name).ok();
      }
      if (has_answer && !is_any_open) break;
      if (is_any_open && ((!is_patient && round > 0) || !backoff.wait())) break;
      // A memory that no server has may have moved or arrived since the servers were found.
      servers->refresh(is_any_open ? Duration(kFirstWait) : Duration(0));
      if (is_any_open) continue;
      if (servers->all() == before || round > 0) break;
      asking = {};
    }
    return united(query, std::move(asking), !is_patient);
  }

  [[nodiscard]] Result<RobotAnswer> united(const ltm::Query& query, Asking asking,
                                           bool is_partial) const {
    RobotAnswer answer{ltm::QueryResult(query.is_ids_only()), {}};
    std::vector<ServerOutcome> failed;
    std::vector<ServerOutcome> without;
    bool has_answer = false;
    for (const auto& [name, server] : asking.servers) {
      auto& one = asking.answers.at(name);
      if (one.ok()) {
        has_answer = true;
        ENGRAM_RETURN_IF_ERROR(answer.result.merge(*std::move(one)));
      } else if (one.status().code() == StatusCode::kNotFound) {
        without.push_back({name, one.status()});
      } else {
        (is_lost(one.status()) ? answer.missing : failed).push_back({name, one.status()});
      }
    }
    for (ServerOutcome& gone : nobody_has(query)) answer.missing.push_back(std::move(gone));
    if (!failed.empty()) return joined(failed);
    const bool is_enough = is_partial && (has_answer || !without.empty());
    if (!answer.missing.empty() && !is_enough) return joined(answer.missing);
    if (has_answer || !answer.missing.empty()) return answer;
    if (!without.empty()) return joined(without);
    return not_found("no server has what '{}' asks for", query.to_string());
  }

  [[nodiscard]] std::vector<ServerOutcome> nobody_has(const ltm::Query& query) const {
    std::vector<ServerOutcome> gone;
    for (const auto& [memory, server] : servers->gone(query))
      gone.push_back({server, unavailable("is gone, and nobody else has memory '{}'", memory)});
    return gone;
  }
};

RobotMemory::RobotMemory(std::shared_ptr<State> state) : state_(std::move(state)) {}
RobotMemory::~RobotMemory() = default;

Result<std::unique_ptr<RobotMemory>> RobotMemory::connect(const std::string& names,
                                                          const ClientOptions& options) {
  auto state = std::make_shared<State>();
  ENGRAM_ASSIGN_OR_RETURN(state->servers, RobotServers::connect(names, options));
  return std::unique_ptr<RobotMemory>(new RobotMemory(std::move(state)));
}

Status RobotMemory::commit(const ltm::Commit& commit, CommitDurability durability,
                           std::vector<ServerOutcome>* outcomes) {
  std::vector<ServerOutcome> all;
  const Status status = state_->commit(commit, durability, all);
  if (outcomes != nullptr) *outcomes = std::move(all);
  return status;
}

Result<ltm::QueryResult> RobotMemory::query(const ltm::Query& query, const std::string& engine) {
  ENGRAM_ASSIGN_OR_RETURN(RobotAnswer answer,
                          state_->query(query, state_->asks_whole(query, engine), true));
  return std::move(answer.result);
}

Status RobotMemory::query_parts(const ltm::Query& query, const Memory::PartVisit& visit,
                                const std::string& engine) {
  return state_->query(query, state_->asks_in_parts(query, engine, visit), true).status();
}

Result<RobotAnswer> RobotMemory::query_reachable(const ltm::Query& query,
                                                 const std::string& engine) {
  return state_->query(query, state_->asks_whole(query, engine), false);
}

Status RobotMemory::declare(const ltm::MemoryId& segment, const idf::Type& type) {
  if (segment.names().empty()) return invalid_argument("found no segment, needs one to declare");
  return state_->at_holder(segment.names()[0],
                           [&](MemoryClient& client) { return client.declare(segment, type); });
}

Result<std::vector<ltm::SnapshotResult>> RobotMemory::predict(const ltm::MemoryId& entity,
                                                              std::span<const Duration> horizons,
                                                              const PredictOptions& options) {
  Result<std::vector<ltm::SnapshotResult>> predicted = cancelled("not asked");
  ENGRAM_RETURN_IF_ERROR(state_->at_holder(entity.names()[0], [&](MemoryClient& client) {
    predicted = client.predict(entity, horizons, options);
    // kNotFound is a valid answer here: the server has no such entity, engine or moment.
    return is_lost(predicted.status()) ? predicted.status() : Status();
  }));
  return predicted;
}

Result<std::vector<std::vector<ltm::EngineRecord>>> RobotMemory::engines(
    const ltm::MemoryId& entity, std::span<const Duration> horizons, std::optional<Time> at) {
  if (!entity.has_entity())
    return invalid_argument("'{}': needs the ID of an entity", entity.to_string());
  Result<std::vector<std::vector<ltm::EngineRecord>>> records = cancelled("not asked");
  ENGRAM_RETURN_IF_ERROR(state_->at_holder(entity.names()[0], [&](MemoryClient& client) {
    records = client.engines(entity, horizons, at);
    // kNotFound is a valid answer here: the server has no such entity.
    return is_lost(records.status()) ? records.status() : Status();
  }));
  return records;
}

Result<ltm::SimilarAnswer> RobotMemory::similar(const ltm::SimilarRequest& request) {
  if (!request.entity.has_entity())
    return invalid_argument("'{}': needs the ID of an entity", request.entity.to_string());
  Result<ltm::SimilarAnswer> answer = cancelled("not asked");
  ENGRAM_RETURN_IF_ERROR(state_->at_holder(request.entity.names()[0], [&](MemoryClient& client) {
    answer = client.similar(request);
    // kNotFound is a valid answer here: the server has no such entity or moment.
    return is_lost(answer.status()) ? answer.status() : Status();
  }));
  return answer;
}

Result<std::unique_ptr<Subscription>> RobotMemory::subscribe(const SubscriptionOptions& options,
                                                             SubscriptionHandlers handlers) {
  return subscribe_to_robot(*state_->servers, state_, options, std::move(handlers));
}

Status RobotMemory::wait_for_memory(const std::string& name, Duration timeout) {
  Backoff backoff(steady_now() + timeout);
  for (;;) {
    Status status = state_->servers->renew();
    if (const auto holder = state_->servers->holder(name)) {
      const auto client = state_->servers->client(*holder);
      const auto info = client.ok() ? (*client)->info() : client.status();
      if (info.ok()) return {};
      status = info.status();
      if (client.ok()) state_->servers->drop(holder->server, client->get());
    } else if (status.ok()) {
      status = not_found("no server has it");
    }
    if (!backoff.wait())
      return unavailable("memory '{}' is not there after {}: {}", name, to_string(timeout),
                         status.message());
  }
}

Result<std::vector<RobotServer>> RobotMemory::info() {
  const Status renewed = state_->servers->renew();
  if (!renewed.ok()) return renewed;
  std::vector<RobotServer> servers;
  for (Registration& one : state_->servers->all())
    servers.push_back({std::move(one), unavailable("not asked")});
  at_once(servers.size(), [&](size_t i) {
    const auto client = state_->servers->client(servers[i].registration);
    servers[i].info = client.ok() ? (*client)->info() : client.status();
    if (client.ok() && is_lost(servers[i].info.status()))
      state_->servers->drop(servers[i].registration.server, client->get());
  });
  return servers;
}

}  // namespace engram::server
