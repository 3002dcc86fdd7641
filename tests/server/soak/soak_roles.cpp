// SPDX-License-Identifier: Apache-2.0
#include "tests/server/soak/soak_roles.h"

#include <signal.h>

#include <atomic>
#include <set>
#include <thread>

#include "ltm/core/log.h"
#include "server/client/names_client.h"
#include "server/client/robot_memory.h"
#include "server/robot/memory_server.h"
#include "server/rpc/names_rpc.h"
#include "tests/server/soak/soak_ledger.h"

namespace engram::soak {

using namespace engram::server;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

std::atomic<bool> is_told_to_end{false};

void listen_to_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { is_told_to_end = true; };
  ::sigaction(SIGTERM, &action, nullptr);
  // Held back since before this program began: see Process::start.
  sigset_t term;
  ::sigemptyset(&term);
  ::sigaddset(&term, SIGTERM);
  ::sigprocmask(SIG_UNBLOCK, &term, nullptr);
}

void wait_for_end() {
  while (!is_told_to_end) std::this_thread::sleep_for(milliseconds(20));
}

Result<std::unique_ptr<RobotMemory>> robot(const std::filesystem::path& folder) {
  ClientOptions options;
  options.timeout = seconds(15);
  return RobotMemory::connect(names_endpoint(folder), options);
}

/// Each datum says its own time, and has some weight.
idf::Data datum(int64_t at) {
  return idf::Dict{{"at", at}, {"weight", std::string(static_cast<size_t>(at % 4000), 'x')}};
}

bool is_right(const idf::Data& data, Time time) {
  return data == datum(to_ns(time));
}

}  // namespace

std::string memory_name(int index) {
  return std::string(1, static_cast<char>('A' + index));
}

std::string entity_name(const std::string& memory, int writer) {
  return fmt::format("{}/soak/writer/entity{}", memory, writer);
}

std::string names_endpoint(const std::filesystem::path& folder) {
  return "unix:" + (folder / "names.sock").string();
}

std::filesystem::path store_path(const std::filesystem::path& folder, const std::string& memory) {
  return folder / (memory + ".engram");
}

std::filesystem::path ledger_path(const std::filesystem::path& folder, const std::string& memory,
                                  int writer) {
  return folder / fmt::format("acknowledged_{}_{}", memory, writer);
}

std::filesystem::path reader_path(const std::filesystem::path& folder, int reader) {
  return folder / fmt::format("reader_{}", reader);
}

Status run_names(const std::filesystem::path& folder) {
  listen_to_signals();
  ENGRAM_ASSIGN_OR_RETURN(const auto registry,
                          NameRegistry::create({}, static_cast<uint64_t>(to_ns(system_now()))));
  const AccessPolicy access = AccessPolicy::everyone();
  const auto rpc = make_names_rpc(*registry, access);
  RpcServer::Options options;
  ENGRAM_ASSIGN_OR_RETURN(const Endpoint endpoint, Endpoint::parse(names_endpoint(folder)));
  options.endpoints = {endpoint};
  ENGRAM_ASSIGN_OR_RETURN(const auto server, RpcServer::start(options, {rpc.get()}));
  wait_for_end();
  server->stop(milliseconds(100));
  return {};
}

Status run_memory(const std::filesystem::path& folder, const std::string& memory, int start) {
  listen_to_signals();
  ENGRAM_ASSIGN_OR_RETURN(const auto names, NamesClient::connect(names_endpoint(folder)));
  MemoryServer::Options options;
  options.service.name = "server-" + memory;
  options.service.memories = {memory};
  options.service.memory.all.bytes = size_t{8} << 20;
  options.service.memory.max_waiting_bytes = size_t{32} << 20;
  options.service.store.emplace();
  options.service.store->store = store_path(folder, memory);
  options.service.store->recording.store.min_free_bytes = 0;
  options.service.store->recording.store.seal_bytes = size_t{4} << 20;
  options.service.store->max_decoded_bytes = size_t{8} << 20;
  options.durability = memory::MemoryService::Durability::kJournal;
  ENGRAM_ASSIGN_OR_RETURN(
      const Endpoint endpoint,
      Endpoint::parse(fmt::format("unix:{}/{}{}.sock", folder.string(), memory, start % 2)));
  options.rpc.endpoints = {endpoint};
  ENGRAM_ASSIGN_OR_RETURN(const auto server, MemoryServer::start(options, nullptr, names.get()));
  wait_for_end();
  return server->stop();
}

Status run_writer(const std::filesystem::path& folder, int index) {
  listen_to_signals();
  ENGRAM_ASSIGN_OR_RETURN(const auto client, robot(folder));
  std::vector<std::unique_ptr<Ledger>> ledgers;
  for (int i = 0; i < kServers; ++i)
    ledgers.push_back(std::make_unique<Ledger>(ledger_path(folder, memory_name(i), index)));
  while (!is_told_to_end) {
    const int64_t at = to_ns(system_now());
    ltm::Commit commit;
    for (int i = 0; i < kServers; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(const auto entity,
                              ltm::MemoryId::parse(entity_name(memory_name(i), index)));
      commit.updates.push_back({entity, time_from_ns(at), {{datum(at), {}}}});
    }
    std::vector<ServerOutcome> outcomes;
    (void)client->commit(commit, CommitDurability::kJournal, &outcomes);
    // What one server acknowledged counts, whatever others say.
    for (int i = 0; i < kServers; ++i)
      for (const ServerOutcome& outcome : outcomes)
        if (outcome.server == "server-" + memory_name(i) && outcome.status.ok())
          ledgers[static_cast<size_t>(i)]->write(at);
    std::this_thread::sleep_for(milliseconds(5));
  }
  return {};
}

Status run_reader(const std::filesystem::path& folder, int index) {
  listen_to_signals();
  const Ledger counts(reader_path(folder, index));
  ENGRAM_ASSIGN_OR_RETURN(const auto client, robot(folder));
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [&counts](const std::vector<ToldSnapshot>& told) {
    for (const ToldSnapshot& one : told)
      counts.write(one.has_data && !is_right(one.snapshot.instances[0].data, one.snapshot.time)
                       ? kWrong
                       : kTold);
  };
  handlers.on_interrupted = [&counts](const Status& /*status*/) { counts.write(kInterrupted); };
  ENGRAM_ASSIGN_OR_RETURN(
      const auto subscription,
      client->subscribe({.names = {}, .with_data = index % 2 == 0}, std::move(handlers)));
  const std::vector<std::string> texts = {".* @ latest:5", entity_name("A", index) + " @ latest:30",
                                          "[AB] @ last:200ms", entity_name("B", index) + " @ 0..3",
                                          "?ids C @ latest:20"};
  std::set<std::string> why;  // Each reason once.
  for (size_t i = 0; !is_told_to_end; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::parse(texts[i % texts.size()]));
    const auto answer = client->query(query);
    ReaderCount count = answer.ok() ? kAnswers : kFailed;
    if (!answer.ok() && why.insert(answer.status().message()).second && why.size() < 20)
      fmt::print(stderr, "reader {}: {}\n", index, answer.status().to_string());
    if (answer.ok() && !query.is_ids_only())
      for (const ltm::EntityResult* entity : answer->entities())
        for (const ltm::SnapshotResult& one : entity->snapshots)
          if (!is_right(one.instances[0].data, one.time)) count = kWrong;
    counts.write(count);
    std::this_thread::sleep_for(milliseconds(20));
  }
  return {};
}

}  // namespace engram::soak
