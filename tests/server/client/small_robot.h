// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "server/client/robot_memory.h"
#include "tests/server/robot/running_names.h"
#include "tests/server/robot/running_server.h"

namespace engram::testing {

/// A name system and memory servers in one process, each with a memory of its name.
class SmallRobot {
 public:
  SmallRobot() {
    names.options.heartbeat_interval = std::chrono::milliseconds(100);
    names.start();
    options.timeout = std::chrono::seconds(5);
  }

  /// Starts the server of a memory, with a store that outlives it; `at` tells its sockets apart.
  void start(const std::string& memory, const std::string& at = "s") {
    auto& one = servers_[memory];
    server::MemoryServer::Options with;
    with.service.name = memory + "-server";
    with.service.memories = {memory};
    with.service.store.emplace();
    with.service.store->store = folder.path() / (memory + ".engram");
    with.service.store->recording.store.min_free_bytes = 0;
    with.service.store->recording.store.durability = ltm::Durability::kNone;
    with.rpc.endpoints = {*server::Endpoint::parse(endpoint(memory, at))};
    one.names = names.client();
    auto started = server::MemoryServer::start(with, nullptr, one.names.get());
    ASSERT_TRUE(started.ok()) << started.status().to_string();
    one.server = *std::move(started);
  }

  /// In order; it says that it leaves.
  void stop(const std::string& memory) { servers_.at(memory).server.reset(); }

  [[nodiscard]] std::string endpoint(const std::string& memory, const std::string& at = "s") const {
    return fmt::format("unix:{}/{}{}", folder.path().string(), memory, at);
  }

  [[nodiscard]] std::unique_ptr<server::RobotMemory> client() const {
    auto made = server::RobotMemory::connect(names.endpoint(), options);
    EXPECT_TRUE(made.ok()) << made.status().to_string();
    return *std::move(made);
  }

  /// One update per entity.
  static ltm::Commit commit(const std::vector<std::string>& entities, int64_t at) {
    ltm::Commit made;
    for (const std::string& entity : entities)
      made.updates.push_back({*ltm::MemoryId::parse(entity), time_from_ns(at), {{at, {}}}});
    return made;
  }

  /// The IDs of what is answered.
  static Result<std::vector<std::string>> ask(server::RobotMemory& client,
                                              const std::string& query) {
    ENGRAM_ASSIGN_OR_RETURN(const auto result, client.query(*ltm::Query::parse(query)));
    std::vector<std::string> ids;
    for (const ltm::EntityResult* one : result.entities())
      for (const ltm::SnapshotResult& snapshot : one->snapshots)
        ids.push_back(fmt::format("{}@{}", one->id.to_string(), to_ns(snapshot.time)));
    return ids;
  }

  ScratchDirectory folder;
  RunningNames names;
  server::ClientOptions options;

 private:
  struct One {
    std::unique_ptr<server::NamesClient> names;
    std::unique_ptr<server::MemoryServer> server;
  };
  std::map<std::string, One> servers_;
};

}  // namespace engram::testing
