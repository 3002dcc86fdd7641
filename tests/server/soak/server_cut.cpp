// SPDX-License-Identifier: Apache-2.0
// The parts of a robot on several hosts, each started by experiments/server_cut.sh:
//
//     server_cut names  ENDPOINT FOLDER
//     server_cut memory ENDPOINT FOLDER NAMES MEMORY
//     server_cut client NAMES    FOLDER SECONDS MEMORY...
//
// FOLDER has ca.pem, server.pem, server.key, tokens.yaml and token. The client prints when commits
// to a memory, and what it is told of it, begin to fail and to work.
#include <fmt/format.h>
#include <signal.h>

#include <atomic>
#include <map>
#include <mutex>
#include <thread>

#include "ltm/core/file.h"
#include "server/client/names_client.h"
#include "server/client/robot_memory.h"
#include "server/robot/memory_server.h"
#include "server/rpc/names_rpc.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Told at least so often where all is well: commits come every 50 ms.
constexpr Duration kPause = milliseconds(1000);

std::atomic<bool> is_told_to_end{false};

void wait_for_end() {
  struct sigaction action {};
  action.sa_handler = [](int) { is_told_to_end = true; };
  ::sigaction(SIGTERM, &action, nullptr);
  while (!is_told_to_end) std::this_thread::sleep_for(milliseconds(20));
}

Result<ClientOptions> client_options(const std::filesystem::path& folder) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer token, read_file(folder / "token"));
  ClientOptions options;
  options.token = std::string(as_text(token.bytes()));
  options.ca = folder / "ca.pem";
  options.timeout = milliseconds(1500);
  return options;
}

Result<RpcServer::Options> listening(const std::string& endpoint,
                                     const std::filesystem::path& folder) {
  RpcServer::Options options;
  ENGRAM_ASSIGN_OR_RETURN(const Endpoint place, Endpoint::parse(endpoint));
  options.endpoints = {place};
  options.security.certificate = folder / "server.pem";
  options.security.key = folder / "server.key";
  options.security.tokens = folder / "tokens.yaml";
  return options;
}

Status run_names(const std::string& endpoint, const std::filesystem::path& folder) {
  ENGRAM_ASSIGN_OR_RETURN(const auto registry,
                          NameRegistry::create({}, static_cast<uint64_t>(to_ns(system_now()))));
  ENGRAM_ASSIGN_OR_RETURN(const AccessPolicy access,
                          AccessPolicy::read_file(folder / "tokens.yaml"));
  const auto rpc = make_names_rpc(*registry, access);
  ENGRAM_ASSIGN_OR_RETURN(const auto options, listening(endpoint, folder));
  ENGRAM_ASSIGN_OR_RETURN(const auto server, RpcServer::start(options, {rpc.get()}));
  wait_for_end();
  return {};
}

Status run_memory(const std::string& endpoint, const std::filesystem::path& folder,
                  const std::string& names, const std::string& memory) {
  ENGRAM_ASSIGN_OR_RETURN(const ClientOptions client, client_options(folder));
  ENGRAM_ASSIGN_OR_RETURN(const auto name_system, NamesClient::connect(names, client));
  MemoryServer::Options options;
  options.service.name = "server-" + memory;
  options.service.memories = {memory};
  options.service.memory.mode = ltm::StoreMode::kLatest;
  ENGRAM_ASSIGN_OR_RETURN(options.rpc, listening(endpoint, folder));
  options.tokens = folder / "tokens.yaml";
  ENGRAM_ASSIGN_OR_RETURN(const auto server,
                          MemoryServer::start(options, nullptr, name_system.get()));
  wait_for_end();
  return server->stop();
}

/// Prints when something begins to work or to fail.
class Watched {
 public:
  explicit Watched(std::string what) : what_(std::move(what)) {}

  void is(bool works) {
    const std::scoped_lock lock(mutex_);
    if (works) last_ = steady_now();
    if (was_ && *was_ == works) return;
    was_ = works;
    fmt::print("{:.3f} {} {}\n", to_seconds(system_now().time_since_epoch()), what_,
               works ? "works" : "fails");
    std::fflush(stdout);
  }

  /// Fails where it has not worked for long.
  void look() {
    SteadyTime last;
    {
      const std::scoped_lock lock(mutex_);
      last = last_;
    }
    if (last != SteadyTime() && steady_now() - last > kPause) is(false);
  }

 private:
  const std::string what_;
  std::mutex mutex_;
  std::optional<bool> was_;
  SteadyTime last_{};
};

Status run_client(const std::string& names, const std::filesystem::path& folder, Duration length,
                  const std::vector<std::string>& memories) {
  ENGRAM_ASSIGN_OR_RETURN(const ClientOptions options, client_options(folder));
  ENGRAM_ASSIGN_OR_RETURN(const auto client, RobotMemory::connect(names, options));
  const SteadyTime end = steady_now() + length;
  std::map<std::string, std::unique_ptr<Watched>> told;
  for (const std::string& memory : memories) {
    ENGRAM_RETURN_IF_ERROR(client->wait_for_memory(memory, seconds(20)));
    told[memory] = std::make_unique<Watched>("told-of-" + memory);
  }
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [&told](const std::vector<ToldSnapshot>& all) {
    for (const ToldSnapshot& one : all) told.at(one.snapshot.entity.names()[0])->is(true);
  };
  ENGRAM_ASSIGN_OR_RETURN(const auto subscription, client->subscribe({}, std::move(handlers)));
  std::vector<std::jthread> threads;
  for (const std::string& memory : memories)
    threads.emplace_back([&, memory] {
      Watched commits("commit-to-" + memory);
      Watched queries("query-of-" + memory);
      const auto entity = *ltm::MemoryId::parse(memory + "/b/c/d");
      const auto query = *ltm::Query::parse(memory + "/b/c/d");
      while (steady_now() < end) {
        const int64_t at = to_ns(system_now());
        commits.is(client->commit({{{entity, time_from_ns(at), {{at, {}}}}}}).ok());
        queries.is(client->query(query).ok());
        told.at(memory)->look();
        std::this_thread::sleep_for(milliseconds(50));
      }
    });
  return {};
}

Status run(const std::vector<std::string>& words) {
  if (words.size() == 3 && words[0] == "names") return run_names(words[1], words[2]);
  if (words.size() == 5 && words[0] == "memory")
    return run_memory(words[1], words[2], words[3], words[4]);
  if (words.size() >= 5 && words[0] == "client")
    return run_client(words[1], words[2], seconds(std::stoi(words[3])),
                      {words.begin() + 4, words.end()});
  return invalid_argument("needs names, memory or client, and what these need");
}

}  // namespace
}  // namespace engram::server

int main(int count, char** words) {
  const engram::Status status = engram::server::run({words + 1, words + count});
  if (!status.ok()) fmt::print(stderr, "server_cut: {}\n", status.to_string());
  return status.ok() ? 0 : 1;
}
